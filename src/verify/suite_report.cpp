#include "verify/suite_report.h"

#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <nlohmann/json.hpp>

namespace faceta {

namespace {

constexpr size_t kWidth = 100; // columns of the table
constexpr size_t kTime = 8;    // of them for the seconds

const char* effort_name(Effort effort) {
  return effort == Effort::full ? "full" : "fast";
}

const char* cell_text(Verdict verdict, bool narrow) {
  const char* wide[kVerdictCount] = {"ok", "FAIL", "exc", "-"};
  const char* letters[kVerdictCount] = {".", "F", "e", "-"};
  return (narrow ? letters : wide)[static_cast<int>(verdict)];
}

// Padding counts what is seen, so colours come after it.
std::string paint(const std::string& text, Verdict verdict, bool colour) {
  const char* codes[kVerdictCount] = {"32", "1;31", "33", "2"};
  return colour ? fmt::format("\x1b[{}m{}\x1b[0m", codes[static_cast<int>(verdict)], text) : text;
}

// Lines of at most kWidth columns, the first and the others with margins of their own.
std::string wrap(const std::string& text, size_t first, size_t others) {
  std::string result, line(first, ' ');
  bool begun = false;
  size_t position = 0;
  while (position < text.size()) {
    size_t end = std::min(text.find_first_of(" \n", position), text.size());
    std::string word = text.substr(position, end - position);
    position = end + 1;
    if (word.empty())
      continue;
    if (begun && line.size() + 1 + word.size() > kWidth) {
      result += line + "\n";
      line.assign(others, ' ');
      begun = false;
    }
    line += (begun ? " " : "") + word;
    begun = true;
  }
  return result + line + "\n";
}

double seconds_of(const std::vector<PropertyResult>& results) {
  double sum = 0;
  for (const PropertyResult& r : results)
    sum += r.seconds;
  return sum;
}

// A table of verdicts: full names of the properties where they fit, else their beginnings.
class Table {
public:
  Table(const std::vector<std::string>& properties, const std::vector<std::string>& names,
        bool colour)
      : colour_(colour) {
    size_t longest = 0, full = 0;
    for (const std::string& n : names)
      longest = std::max(longest, n.size());
    for (const std::string& p : properties)
      full += std::max<size_t>(p.size(), 4) + 2;
    bool fits = longest + full + kTime <= kWidth;
    size_t each = std::clamp<size_t>((kWidth - kTime - std::min<size_t>(longest, 36)) /
                                         std::max<size_t>(properties.size(), 1),
                                     2, 5);
    narrow_ = !fits && each < 5;
    size_t used = 0;
    for (const std::string& p : properties) {
      size_t width = fits ? std::max<size_t>(p.size(), 4) + 2 : each;
      widths_.push_back(width);
      header_ += fmt::format("{:<{}}", p.substr(0, width - 1), width);
      used += width;
    }
    name_width_ = std::min(longest, used + kTime < kWidth ? kWidth - used - kTime : 8);
  }

  std::string header() const {
    return fmt::format("{:<{}}  {}{:>{}}\n", "", name_width_, header_, "time", kTime - 2);
  }

  std::string row(const std::string& name, const std::vector<PropertyResult>& results) const {
    std::string shown = name;
    if (shown.size() > name_width_)
      shown = shown.substr(0, name_width_ - 2) + "..";
    std::string text = fmt::format("{:<{}}  ", shown, name_width_);
    for (size_t i = 0; i < results.size(); ++i) {
      Verdict v = results[i].verdict;
      text += paint(fmt::format("{:<{}}", cell_text(v, narrow_), widths_[i]), v, colour_);
    }
    return text + fmt::format("{:>{}.1f}s\n", seconds_of(results), kTime - 3);
  }

private:
  std::vector<size_t> widths_;
  std::string header_;
  size_t name_width_ = 0;
  bool narrow_ = false, colour_;
};

template <class P> std::vector<std::string> names_of(const std::vector<const P*>& properties) {
  std::vector<std::string> names;
  for (const P* p : properties)
    names.emplace_back(p->name);
  return names;
}

std::string tables(const SuiteReport& report, bool colour) {
  std::vector<std::string> names;
  std::string text;
  if (!report.models.empty() && !report.model_properties.empty()) {
    for (const ModelReport& m : report.models)
      names.push_back(m.model->name());
    Table table(names_of(report.model_properties), names, colour);
    text += table.header();
    for (const ModelReport& m : report.models)
      text += table.row(m.model->name(), m.results);
    text += "\n";
  }
  if (report.subjects.empty() || report.properties.empty())
    return text;
  names.clear();
  for (const SubjectReport& s : report.subjects)
    names.push_back(s.subject.name);
  Table table(names_of(report.properties), names, colour);
  text += table.header();
  for (const SubjectReport& s : report.subjects)
    text += table.row(s.subject.name, s.results);
  return text + "\n";
}

std::string one_subject(const SubjectReport& s, const std::vector<const Property*>& properties,
                        bool colour) {
  std::string text = wrap(s.subject.name, 0, 2);
  for (size_t i = 0; i < s.results.size(); ++i) {
    const PropertyResult& r = s.results[i];
    std::string figure = r.figure != 0 ? fmt::format("{:.4g}", r.figure) : "";
    text += fmt::format("  {:<12} {} {:>10}  {:<58}{:>6.1f}s\n", r.property,
                        paint(fmt::format("{:<4}", cell_text(r.verdict, false)), r.verdict, colour),
                        figure, properties[i]->claim, r.seconds);
  }
  return text + "\n";
}

// Calls use(name, claim, result) for every result.
template <class Use> void for_each_result(const SuiteReport& report, const Use& use) {
  for (const ModelReport& m : report.models)
    for (size_t i = 0; i < m.results.size(); ++i)
      use(m.model->name(), m.model->descriptor, report.model_properties[i]->claim, m.results[i]);
  for (const SubjectReport& s : report.subjects)
    for (size_t i = 0; i < s.results.size(); ++i)
      use(s.subject.name, s.subject.subject.descriptor(), report.properties[i]->claim,
          s.results[i]);
}

std::string failures(const SuiteReport& report, bool colour) {
  std::string text;
  for_each_result(report, [&](const std::string& name, const Descriptor&, const std::string& claim,
                              const PropertyResult& r) {
    if (r.verdict == Verdict::failed)
      text += paint(fmt::format("FAILED {}: {}", name, r.property), Verdict::failed, colour) +
              fmt::format(" ({})\n", claim) + wrap(r.text, 2, 2);
  });
  return text;
}

// One entry for each excuse of a model, with all that it was needed for.
std::string excuses(const SuiteReport& report) {
  struct Entry {
    std::string reason, reference, names;
  };
  std::map<std::pair<std::string, std::string>, Entry> entries;
  for_each_result(report, [&](const std::string& name, const Descriptor& descriptor,
                              const std::string&, const PropertyResult& r) {
    if (r.verdict != Verdict::excused)
      return;
    Entry& entry = entries[{descriptor.name, r.property}];
    entry.reason = r.reason;
    entry.reference = r.reference;
    entry.names += fmt::format("{}{} ({:.4g})", entry.names.empty() ? "" : ", ", name, r.figure);
  });
  std::string text;
  for (const auto& [key, entry] : entries)
    text += wrap(fmt::format("excused {}: {}: {}: {} ({})", key.first, key.second, entry.names,
                             entry.reason, entry.reference),
                 0, 2);
  return text;
}

std::string summary(const SuiteReport& report, bool colour) {
  std::string counts;
  size_t total = 0;
  for (int v = 0; v < kVerdictCount; ++v) {
    size_t n = report.count(static_cast<Verdict>(v));
    total += n;
    counts += fmt::format("{}{} {}", v ? ", " : "", n, name_of(static_cast<Verdict>(v)));
  }
  auto amount = [](size_t n, const char* what) {
    return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s");
  };
  Verdict verdict = report.passed() ? Verdict::passed : Verdict::failed;
  return paint(report.passed() ? "PASSED" : "FAILED", verdict, colour) +
         fmt::format(" {}, {}: {}\n", amount(report.subjects.size(), "subject"),
                     amount(total, "check"), counts) +
         fmt::format("{} effort, seed {}, chance of any false alarm {:g}, {:.1f} s\n",
                     effort_name(report.effort), report.seed, report.family_level, report.seconds);
}

using Json = nlohmann::ordered_json;

Json result_json(const PropertyResult& r) {
  Json json = {{"property", r.property},
               {"verdict", name_of(r.verdict)},
               {"figure", r.figure},
               {"text", r.text}};
  if (r.verdict == Verdict::excused)
    json["reason"] = r.reason, json["reference"] = r.reference;
  json["seconds"] = r.seconds;
  return json;
}

Json results_json(const std::vector<PropertyResult>& results) {
  Json json = Json::array();
  for (const PropertyResult& r : results)
    json.push_back(result_json(r));
  return json;
}

Json subject_json(const SubjectReport& s) {
  const Subject& subject = s.subject.subject;
  Json json = {{"name", s.subject.name},
               {"model", subject.descriptor().name},
               {"origin", name_of(s.subject.origin)}};
  if (s.subject.origin == Origin::exemplar)
    json["exemplar"] = s.subject.exemplar;
  if (s.subject.origin == Origin::scene)
    json["where"] = s.subject.where;
  json["lossless"] = subject.lossless;
  json["parameters"] = Json::object();
  for (const auto& [name, value] : subject.given())
    json["parameters"][name] = value;
  if (subject.tree)
    json["tree"] = subject.tree->text();
  json["seconds"] = seconds_of(s.results);
  json["results"] = results_json(s.results);
  return json;
}

} // namespace

std::string list_properties() {
  std::string text;
  for (const Property& p : subject_properties())
    text += fmt::format("{:<12}  {}\n", p.name, p.claim);
  for (const ModelProperty& p : model_properties())
    text += fmt::format("{:<12}  {}\n", p.name, p.claim);
  return text;
}

std::string suite_text(const SuiteReport& report, bool colour) {
  bool single = report.subjects.size() == 1 && report.models.empty();
  std::string text =
      single ? one_subject(report.subjects[0], report.properties, colour) : tables(report, colour);
  text += failures(report, colour);
  if (!report.passed())
    text += "\n";
  std::string remarks = excuses(report);
  for (const std::string& note : report.notes)
    remarks += wrap("note: " + note, 0, 2);
  return text + remarks + (remarks.empty() ? "" : "\n") + summary(report, colour);
}

std::string suite_json(const SuiteReport& report, const std::string& version) {
  Json json = {{"version", version},
               {"passed", report.passed()},
               {"effort", effort_name(report.effort)},
               {"seed", report.seed},
               {"isa", kIsaNames[static_cast<int>(best_isa())]},
               {"family_level", report.family_level},
               {"test_level", report.test_level},
               {"seconds", report.seconds}};
  json["counts"] = {{"passed", report.count(Verdict::passed)},
                    {"failed", report.count(Verdict::failed)},
                    {"excused", report.count(Verdict::excused)},
                    {"not_applicable", report.count(Verdict::not_applicable)}};
  json["properties"] = Json::array();
  for (const Property* p : report.properties)
    json["properties"].push_back(
        {{"name", p->name}, {"claim", p->claim}, {"of", "subject"}, {"figure", p->figure}});
  for (const ModelProperty* p : report.model_properties)
    json["properties"].push_back({{"name", p->name}, {"claim", p->claim}, {"of", "model"}});
  json["models"] = Json::array();
  for (const ModelReport& m : report.models)
    json["models"].push_back({{"name", m.model->name()},
                              {"title", m.model->descriptor.title},
                              {"results", results_json(m.results)}});
  json["subjects"] = Json::array();
  for (const SubjectReport& s : report.subjects)
    json["subjects"].push_back(subject_json(s));
  json["notes"] = report.notes;
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

} // namespace faceta
