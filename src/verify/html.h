#pragma once

/// Self-contained pages of HTML: one file that loads nothing, easy to read on a phone, in print, in
/// light and in dark.

#include <string>
#include <string_view>

namespace faceta::html {

/// Text as the content of an element or an attribute. Control characters become spaces, bytes that
/// are no UTF-8 become U+FFFD.
std::string escape(std::string_view text);

/// Part of an id or a file name made of a name: lower case letters and digits, others become one
/// hyphen: "roughconductor/all normals" gives "roughconductor-all-normals".
std::string slug(std::string_view text);

/// "<tag>escaped</tag>", with a class if one is given.
std::string element(std::string_view tag, std::string_view text, std::string_view css_class = {});

/// "<a href=\"...\">escaped</a>".
std::string link(std::string_view target, std::string_view text);

/// A table in a frame that scrolls where it is too wide.
std::string scrolling(const std::string& table);

/// The whole file around a body: head, style sheet, and the few lines of script that open a folded
/// part when a link leads there.
std::string page(std::string_view title, const std::string& body);

} // namespace faceta::html
