#include "formats/xml_parameters.h"

#include <algorithm>
#include <cctype>
#include <fmt/format.h>

namespace faceta::xml {

namespace {

constexpr size_t kMaxNameLength = 256;
constexpr size_t kMaxValueLength = size_t{1} << 20;
constexpr size_t kMaxInserted = size_t{256} << 20;
constexpr int kMaxChain = 16;

bool is_name_character(char c) {
  auto u = static_cast<unsigned char>(c);
  return u < 128 && (std::isalnum(u) || c == '_');
}

std::string_view name_at(std::string_view text) {
  size_t end = 0;
  while (end < text.size() && end < kMaxNameLength && is_name_character(text[end]))
    ++end;
  return text.substr(0, end);
}

} // namespace

Parameters::Parameters(const std::vector<std::pair<std::string, std::string>>& defines) {
  for (const auto& [name, value] : defines) {
    if (name.empty() || name.size() > kMaxNameLength)
      throw Error(fmt::format("the name of a define must have 1 to {} characters", kMaxNameLength),
                  {}, "write -Dname=value");
    if (!parameters_.try_emplace(name, Parameter{value, true, false}).second)
      throw Error(fmt::format("parameter '{}' is defined twice (-D{}=...)", name, name));
  }
}

void Parameters::add_default(std::string_view name, std::string_view value,
                             const SourcePosition& where) {
  if (name.empty() || name.size() > kMaxNameLength)
    throw Error(fmt::format("the name of a <default> must have 1 to {} characters", kMaxNameLength),
                where);
  parameters_.try_emplace(std::string(name), Parameter{std::string(value), false, true});
}

Parameters::Map::iterator Parameters::longest_match(std::string_view text) {
  text = text.substr(0, kMaxNameLength);
  // The greatest name not after `text` either begins it, or shares only a shorter beginning with
  // it; any name that begins `text` then begins that shared part too.
  while (!text.empty()) {
    auto next = parameters_.upper_bound(text);
    if (next == parameters_.begin())
      break;
    auto candidate = std::prev(next);
    const std::string& name = candidate->first;
    auto [a, b] = std::mismatch(name.begin(), name.end(), text.begin(), text.end());
    if (a == name.end())
      return candidate;
    text = text.substr(0, static_cast<size_t>(b - text.begin()));
  }
  return parameters_.end();
}

void Parameters::expand_into(std::string& out, std::string_view text, const SourcePosition& where,
                             int depth) {
  if (depth > kMaxChain)
    throw Error("a parameter's value refers to itself, or parameters refer to each other too deep",
                where);
  for (size_t i = 0; i < text.size();) {
    size_t dollar = text.find('$', i);
    if (dollar == text.npos) {
      out += text.substr(i);
      break;
    }
    bool escaped = dollar > i && text[dollar - 1] == '\\';
    out += text.substr(i, dollar - i - (escaped ? 1 : 0));
    i = dollar + 1;
    if (escaped) {
      out += '$';
      continue;
    }
    auto found = longest_match(text.substr(i));
    if (found == parameters_.end()) {
      std::vector<std::string> names;
      for (const auto& [name, parameter] : parameters_)
        names.push_back(name);
      std::string name(name_at(text.substr(i)));
      std::string hint = suggestion(name, names);
      throw Error(fmt::format("undefined parameter '${}'", name), where,
                  hint.empty() ? "set it by <default> before this line or by -D; write \\$ for a "
                                 "dollar sign"
                               : hint);
    }
    i += found->first.size();
    Parameter& parameter = found->second;
    parameter.used = true;
    inserted_ += parameter.value.size();
    if (inserted_ > kMaxInserted || out.size() + parameter.value.size() > kMaxValueLength)
      throw Error("parameter substitution makes the text too long", where);
    if (parameter.value.find('$') == parameter.value.npos)
      out += parameter.value;
    else
      expand_into(out, parameter.value, where, depth + 1);
  }
}

std::string Parameters::expand(std::string_view text, const SourcePosition& where) {
  std::string out;
  expand_into(out, text, where, 0);
  return out;
}

void Parameters::check_unused(bool permissive, const Warn& warn) const {
  std::string unused;
  std::vector<std::string> defaults;
  for (const auto& [name, parameter] : parameters_) {
    if (!parameter.used)
      unused += (unused.empty() ? "" : ", ") + name + "=" + parameter.value;
    if (!parameter.is_define)
      defaults.push_back(name);
  }
  if (unused.empty())
    return;
  std::string message = "the scene does not use the parameter -D " + unused;
  if (!permissive)
    throw Error(message, {},
                defaults.empty() ? "" : suggestion(unused.substr(0, unused.find('=')), defaults));
  if (warn)
    warn("warning: " + message);
}

} // namespace faceta::xml
