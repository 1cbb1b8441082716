#include "verify/suite.h"

#include "verify/in_order.h"
#include "verify/statistics.h"

#include <algorithm>
#include <chrono>
#include <mutex>
#include <new>

namespace faceta {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// Chi-square and density look at each viewer in up to two modes; energy at nine cosines of two
// sides in three channels.
double tests_per_subject(Effort effort) {
  int modes = effort == Effort::full ? 2 : 1;
  return 2.0 * most_viewers(effort) * modes + 9 * 2 * 3;
}

bool wanted(const std::vector<std::string>& only, const std::string& name) {
  return only.empty() || std::find(only.begin(), only.end(), name) != only.end();
}

void choose_properties(SuiteReport& report, const std::vector<std::string>& only) {
  for (const Property& p : subject_properties())
    if (wanted(only, p.name))
      report.properties.push_back(&p);
  for (const ModelProperty& p : model_properties())
    if (wanted(only, p.name))
      report.model_properties.push_back(&p);
  const std::vector<std::string> names = property_names();
  for (const std::string& name : only)
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw Error("there is no property '" + name + "'", {}, suggestion(name, names));
}

template <class Check>
PropertyResult ask(const Descriptor& descriptor, const std::string& property, const Check& check) {
  Clock::time_point start = Clock::now();
  Outcome outcome;
  try {
    outcome = check();
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    outcome.fail(std::string("ended in an exception: ") + error.what());
  }
  PropertyResult result{property,
                        judge(outcome, descriptor, property),
                        outcome.figure,
                        outcome.message,
                        {},
                        {},
                        seconds_since(start)};
  if (result.verdict == Verdict::excused)
    result.reason = find_excuse(descriptor, property)->reason,
    result.reference = find_excuse(descriptor, property)->reference;
  return result;
}

PropertyResult ask_subject(const SuiteSubject& s, const Property& property, Effort effort,
                           double level) {
  for (const Excuse& idle : s.idle)
    if (idle.property == property.name)
      return {property.name, Verdict::not_applicable, 0, idle.reason, {}, {}, 0};
  return ask(s.subject.descriptor(), property.name,
             [&] { return property.check(s.subject, effort, level); });
}

// Counts checks and passes them on, one at a time.
class ProgressCounter {
public:
  ProgressCounter(const SuiteOptions& options, size_t total) : options_(options) {
    progress_.total = total;
  }
  void add(const std::string& name) {
    std::scoped_lock lock(mutex_);
    ++progress_.done;
    progress_.name = name;
    progress_.seconds = seconds_since(start_);
    if (options_.progress)
      options_.progress(progress_);
  }
  double seconds() const { return seconds_since(start_); }

private:
  const SuiteOptions& options_;
  SuiteProgress progress_;
  Clock::time_point start_ = Clock::now();
  std::mutex mutex_;
};

} // namespace

double suite_level(size_t subjects, Effort effort, double family) {
  return sidak(family, double(subjects) * tests_per_subject(effort));
}

std::vector<std::string> property_names() {
  std::vector<std::string> names;
  for (const Property& p : subject_properties())
    names.emplace_back(p.name);
  for (const ModelProperty& p : model_properties())
    names.emplace_back(p.name);
  return names;
}

const char* name_of(Verdict verdict) {
  const char* names[kVerdictCount] = {"passed", "failed", "excused", "not applicable"};
  return names[static_cast<int>(verdict)];
}

const char* name_of(Origin origin) {
  const char* names[] = {"exemplar", "settings", "scene"};
  return names[static_cast<int>(origin)];
}

Verdict judge(const Outcome& outcome, const Descriptor& descriptor, const std::string& property) {
  if (!outcome.passed)
    return outcome.excusable && find_excuse(descriptor, property) ? Verdict::excused
                                                                  : Verdict::failed;
  return outcome.applicable ? Verdict::passed : Verdict::not_applicable;
}

std::vector<SuiteSubject> exemplar_subjects(const Model& model) {
  std::vector<SuiteSubject> subjects;
  for (const Exemplar& e : model.descriptor.exemplars)
    subjects.push_back(
        {model.name() + "/" + e.name, Origin::exemplar, Subject(model, e), e.name, {}, {}});
  return subjects;
}

SuiteSubject tree_subject(const SceneNode& node, const std::string& exemplar,
                          const MaterialNode& root) {
  return {node.descriptor.name + "/" + exemplar,
          Origin::exemplar,
          Subject(std::make_shared<MaterialTree>(root)),
          exemplar,
          {},
          {}};
}

SuiteSubject settings_subject(const Model& model, const Settings& settings) {
  Parameters parameters(model);
  std::string name = model.name();
  for (const auto& [key, value] : settings) {
    parameters.set(key, value);
    name += " " + key + "=" + value;
  }
  parameters.check();
  return {name, Origin::settings, Subject(model, parameters), {}, {}, {}};
}

size_t SuiteReport::count(Verdict verdict) const {
  size_t n = 0;
  auto add = [&](const std::vector<PropertyResult>& results) {
    for (const PropertyResult& r : results)
      n += r.verdict == verdict;
  };
  for (const ModelReport& m : models)
    add(m.results);
  for (const SubjectReport& s : subjects)
    add(s.results);
  return n;
}

SuiteReport run_suite(const std::vector<SuiteSubject>& subjects,
                      const std::vector<const Model*>& models, const SuiteOptions& options) {
  SuiteReport report;
  report.effort = options.effort;
  report.seed = options.seed;
  report.family_level = options.family_level;
  report.test_level = suite_level(subjects.size(), options.effort, options.family_level);
  choose_properties(report, options.only);
  const size_t own = report.model_properties.size(), each = report.properties.size();
  for (const Model* model : models)
    report.models.push_back({model, std::vector<PropertyResult>(own)});
  for (const SuiteSubject& s : subjects) {
    report.subjects.push_back({s, std::vector<PropertyResult>(each)});
    report.subjects.back().subject.subject.seed = options.seed;
  }
  const size_t first = models.size() * own, total = first + subjects.size() * each;
  if (total == 0)
    throw Error("there is nothing to verify: no subject has any of the properties asked for");
  ProgressCounter counter(options, total);
  run_in_order(total, [&](size_t task) {
    if (task < first) {
      ModelReport& m = report.models[task / own];
      const ModelProperty& p = *report.model_properties[task % own];
      m.results[task % own] = ask(m.model->descriptor, p.name, [&] { return p.check(*m.model); });
      counter.add(m.model->name() + " " + p.name);
      return;
    }
    SubjectReport& s = report.subjects[(task - first) / each];
    const Property& p = *report.properties[(task - first) % each];
    s.results[(task - first) % each] = ask_subject(s.subject, p, options.effort, report.test_level);
    counter.add(s.subject.name + " " + p.name);
  });
  report.seconds = counter.seconds();
  return report;
}

} // namespace faceta
