"""A page of HTML as a browser reads it."""

import html.parser
import re

VOID = {"meta", "br", "img", "hr", "link", "input"}
# What makes a browser fetch something.
LOADS = {"src", "href", "data", "srcset", "poster", "action", "xlink:href"}


class Page(html.parser.HTMLParser):
    """Tags must nest; collects ids, links, what would be loaded, and the text by element."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.open, self.ids, self.links, self.loads, self.errors = [], [], [], [], []
        self.text, self.elements, self.details = [], [], []
        self.source = text
        self.feed(text)
        self.close()
        if self.open:
            self.errors.append(f"never closed: {self.open}")

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        self.elements.append((tag, attributes))
        if tag == "details":
            self.details.append(attributes)
        if "id" in attributes:
            self.ids.append(attributes["id"])
        for name in LOADS & set(attributes):
            (self.links if tag == "a" else self.loads).append(attributes[name])
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        self.handle_starttag(tag, attributes)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            self.errors.append(f"</{tag}> at {self.getpos()} closes nothing")

    def handle_data(self, data):
        if self.open and self.open[-1] in ("style", "script"):
            return
        self.text.append(data)

    def repeated_ids(self):
        return sorted({i for i in self.ids if self.ids.count(i) > 1})

    def outside_addresses(self):
        """What a browser could fetch from elsewhere; namespaces are only names."""
        rest = re.sub(r"base64,[A-Za-z0-9+/=]*", "", self.source)
        rest = rest.replace('xmlns="http://www.w3.org/2000/svg"', "")
        return re.findall(r"https?:\S{,40}|[\"'(=]//\S{,40}|url\(.{,40}|@import|fetch\(|XMLHttp", rest)

    def words(self):
        return " ".join(" ".join(self.text).split())
