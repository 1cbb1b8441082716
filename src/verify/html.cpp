#include "verify/html.h"

#include "verify/plot_drawing.h"

#include <cctype>

namespace faceta::html {

namespace {

constexpr const char* kStyle = R"(
:root{--ground:#fff;--text:#1f2328;--muted:#57606a;--line:#d5dbe1;--panel:#f6f8fa;--link:#0759b8;
--ok:#1a7f37;--bad:#c4161c;--exc:#8a5a00}
@media screen and (prefers-color-scheme:dark){:root{--ground:#14181d;--text:#e6edf3;--muted:#a3adb8;
--line:#38404a;--panel:#1c2128;--link:#6cb2ff;--ok:#56c271;--bad:#ff7b72;--exc:#e3b341}}
*{box-sizing:border-box}
html{color-scheme:light dark;-webkit-text-size-adjust:100%;text-size-adjust:100%}
body{margin:0 auto;max-width:76rem;padding:1rem;background:var(--ground);color:var(--text);
font:16px/1.5 system-ui,-apple-system,"Segoe UI",Roboto,"DejaVu Sans",sans-serif;overflow-wrap:break-word}
a{color:var(--link);text-decoration:none}a:hover{text-decoration:underline}
h1{font-size:1.7rem;line-height:1.2;margin:.4rem 0}
h2{font-size:1.3rem;line-height:1.25;margin:2.2rem 0 .6rem;padding-top:.6rem;border-top:1px solid var(--line)}
h3{font-size:1.05rem;margin:1.2rem 0 .4rem}
p,ul,dl{margin:.5rem 0}ul{padding-left:1.2rem}
code,pre{font:.86em/1.45 ui-monospace,SFMono-Regular,Menlo,"DejaVu Sans Mono",monospace}
pre{overflow-x:auto;background:var(--panel);border:1px solid var(--line);border-radius:6px;padding:.6rem .8rem}
small,.muted{color:var(--muted)}small{font-size:.86em}
.lead{font-size:1.1rem}
.ok{color:var(--ok)}.bad{color:var(--bad);font-weight:700}.exc{color:var(--exc);font-weight:600}
.none{color:var(--muted)}
.scroll{overflow-x:auto;margin:.6rem 0}
table{border-collapse:collapse;font-size:.92rem}
th,td{padding:.28rem .5rem;text-align:left;vertical-align:top;border-bottom:1px solid var(--line)}
thead th{color:var(--muted);font-weight:600;vertical-align:bottom;white-space:nowrap}
th.n,td.n{text-align:right}td.n{font-variant-numeric:tabular-nums;white-space:nowrap}
table.matrix td,table.matrix th{padding:.22rem .3rem;text-align:center}
table.matrix th:first-child{text-align:left;position:sticky;left:0;background:var(--ground);
min-width:7.5rem;max-width:13rem;font-weight:400}
table.matrix thead th+th{writing-mode:vertical-rl;transform:rotate(180deg);text-align:left;line-height:1.1;
padding:.3rem .1rem;font-weight:400}
table.matrix td a{display:block;color:inherit}
dd{margin:0 0 .5rem}dl.facts{display:grid;grid-template-columns:max-content 1fr;gap:.15rem .9rem}
dl.facts dt{color:var(--muted)}dl.facts dd{margin:0}
.plots{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(100%,330px),1fr));gap:1rem 1.4rem;
margin:1rem 0;align-items:start}
.plot{margin:0}.plot svg{display:block;width:100%;height:auto;max-width:420px!important;margin:0 auto}
details{border:1px solid var(--line);border-radius:8px;margin:.6rem 0}
details>.inside{padding:.1rem .8rem .8rem}
summary{cursor:pointer;padding:.55rem .8rem;border-radius:8px}summary:hover{background:var(--panel)}
summary b{margin-right:.6rem}
details[open]>summary{border-bottom:1px solid var(--line);border-radius:8px 8px 0 0}
:target{scroll-margin-top:.5rem}
details:target>summary{background:var(--panel)}
.settings code{display:inline-block;overflow-wrap:anywhere;max-width:100%;box-sizing:border-box;background:var(--panel);border:1px solid var(--line);border-radius:5px;
padding:0 .35rem;margin:.1rem 0}
td .bad{font-weight:400}td>.bad:only-child{font-weight:700}.trouble{border-left:4px solid var(--bad);padding:.1rem .8rem;margin:.6rem 0}
button{font:inherit;color:var(--link);background:var(--panel);border:1px solid var(--line);border-radius:6px;
padding:.2rem .7rem;margin-right:.4rem}
img{max-width:100%;height:auto}
.balls{display:flex;flex-wrap:wrap;gap:.8rem;margin:1rem 0}
.balls figure{margin:0;width:min(160px,calc(50% - .4rem))}.balls figcaption{font-size:.86rem;color:var(--muted)}
.balls img,.ball{border-radius:8px;display:block}
.cards{display:grid;grid-template-columns:repeat(auto-fill,minmax(140px,1fr));gap:1rem}
.cards a{display:block;color:inherit}
.tables{display:flex;flex-wrap:wrap;gap:0 2.5rem;align-items:flex-start}.tables>*{min-width:0;max-width:100%}
@media(max-width:480px){body{padding:.75rem .9rem}dl.facts{grid-template-columns:7rem 1fr}th,td{padding:.25rem .35rem}
table.matrix td,table.matrix th{padding:.22rem .13rem}table.matrix thead th+th{padding:.3rem 0}
table.matrix th:first-child{min-width:6.6rem;max-width:8.2rem;padding-right:.3rem}
table{font-size:.86rem}}
@media(max-width:700px){table.stack,.stack tbody{display:block}.stack thead{display:none}
.stack tr{display:block;padding:.45rem 0;border-bottom:1px solid var(--line)}
.stack td{display:inline-block;border:0;padding:0 .9rem 0 0}.stack td:empty{display:none}
.stack td:first-child,.stack td[data-label=meaning]{display:block}.stack td:first-child code{font-weight:700}
.stack td[data-label]:before{content:attr(data-label) " ";color:var(--muted)}
.stack td[data-label=meaning]:before{content:none}}
@media print{@page{margin:14mm}html{font-size:9.5pt}body{max-width:none;padding:0;font-size:1rem}
button,.screen{display:none!important}a{color:inherit}.scroll{overflow:visible}
section.model{break-before:page}h2,h3,summary{break-after:avoid}h2{border:0}
.plot,tr,pre,.trouble{break-inside:avoid}.plots{grid-template-columns:1fr 1fr 1fr}
details:not([open]){border:0;margin:0}details{border-radius:0}pre{white-space:pre-wrap}
table.matrix th:first-child{position:static}}
)";

constexpr const char* kScript = R"(
function show(){const e=document.getElementById(decodeURIComponent(location.hash.slice(1)));
for(let d=e;d;d=d.parentElement)if(d.tagName=='DETAILS')d.open=true;if(e)e.scrollIntoView()}
addEventListener('hashchange',show);show();
document.querySelectorAll('[data-open]').forEach(b=>{b.hidden=false;b.onclick=()=>
document.querySelectorAll('details').forEach(d=>d.open=b.dataset.open=='1')});
)";

/// The bytes of the UTF-8 character at the front; 0 if they are none.
size_t character_size(std::string_view text) {
  auto byte = [&](size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0; };
  unsigned first = byte(0);
  size_t size = first < 0x80 ? 1 : first < 0xc2 ? 0 : first < 0xe0 ? 2 : first < 0xf0 ? 3 : 4;
  if (first > 0xf4)
    return 0;
  for (size_t i = 1; i < size; ++i)
    if ((byte(i) & 0xc0) != 0x80)
      return 0;
  // Overlong forms, surrogates, and what lies beyond U+10FFFF.
  if ((first == 0xe0 && byte(1) < 0xa0) || (first == 0xed && byte(1) > 0x9f) ||
      (first == 0xf0 && byte(1) < 0x90) || (first == 0xf4 && byte(1) > 0x8f))
    return 0;
  return size;
}

} // namespace

std::string escape(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    size_t size = character_size(text);
    char c = text[0];
    if (size == 0)
      result += "\uFFFD";
    else if (c == '&')
      result += "&amp;";
    else if (c == '<')
      result += "&lt;";
    else if (c == '>')
      result += "&gt;";
    else if (c == '"')
      result += "&quot;";
    else if (size == 1 && c != '\n' && (static_cast<unsigned char>(c) < 0x20 || c == 0x7f))
      result += ' ';
    else
      result += text.substr(0, size);
    text.remove_prefix(size ? size : 1);
  }
  return result;
}

std::string slug(std::string_view text) {
  std::string result;
  for (unsigned char c : text)
    if (c < 0x80 && std::isalnum(c))
      result += char(std::tolower(c));
    else if (!result.empty() && result.back() != '-')
      result += '-';
  while (!result.empty() && result.back() == '-')
    result.pop_back();
  return result;
}

std::string element(std::string_view tag, std::string_view text, std::string_view css_class) {
  std::string result = "<" + std::string(tag);
  if (!css_class.empty())
    result += " class=\"" + std::string(css_class) + "\"";
  return result + ">" + escape(text) + "</" + std::string(tag) + ">";
}

std::string link(std::string_view target, std::string_view text) {
  return "<a href=\"" + escape(target) + "\">" + escape(text) + "</a>";
}

std::string scrolling(const std::string& table) {
  return "<div class=\"scroll\">" + table + "</div>\n";
}

std::string page(std::string_view title, const std::string& body) {
  // The policy makes browsers refuse whatever would be loaded from elsewhere.
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n"
         "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src "
         "'self' "
         "data: file:; style-src 'unsafe-inline'; script-src 'unsafe-inline'\">\n" +
         element("title", title) + "\n<style>" + kStyle + page_plot_style() +
         "</style>\n</head>\n<body>\n" + body + "<script>" + kScript +
         "</script>\n</body>\n</html>\n";
}

} // namespace faceta::html
