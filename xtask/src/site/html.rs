//! What a page refers to, and what can be referred to on it: enough of HTML for pages that programs wrote.

/// A reference of a page.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Reference {
    pub(super) target: String,
    /// The browser fetches it by itself, as a picture or a style.
    pub(super) loaded: bool,
}

/// References and anchors of a page, and where it leads on to.
#[derive(Debug, Default, PartialEq, Eq)]
pub(super) struct Page {
    pub(super) references: Vec<Reference>,
    pub(super) anchors: Vec<String>,
    /// The page that a browser goes on to at once.
    pub(super) redirect: Option<String>,
}

/// Elements whose content is no HTML.
const RAW: [&str; 2] = ["script", "style"];

/// Reads a page; comments, scripts and styles are passed over.
pub(super) fn read(html: &str) -> Page {
    let mut page = Page::default();
    let mut rest = html;
    while let Some(at) = rest.find('<') {
        rest = &rest[at + 1..];
        if let Some(comment) = rest.strip_prefix("!--") {
            rest = comment.split_once("-->").map_or("", |(_, after)| after);
            continue;
        }
        if !rest.starts_with(|c: char| c.is_ascii_alphabetic()) {
            continue; // an end, a declaration
        }
        let end = rest
            .find(|c: char| !c.is_ascii_alphanumeric() && c != '-')
            .unwrap_or(rest.len());
        let (name, after) = rest.split_at(end);
        let name = name.to_ascii_lowercase();
        rest = attributes(after, |attribute, value| page.note(&name, attribute, value));
        if RAW.contains(&name.as_str()) {
            let close = format!("</{name}");
            rest = rest.find(&close).map_or("", |at| &rest[at..]);
        }
    }
    page
}

impl Page {
    fn note(&mut self, element: &str, attribute: &str, value: &str) {
        let value = unescaped(value);
        match attribute {
            "content" if element == "meta" => {
                let target = value
                    .split_once(";URL=")
                    .map(|(_, target)| target.to_owned());
                self.redirect = self.redirect.take().or(target);
            }
            "id" => self.anchors.push(value),
            "name" if element == "a" => self.anchors.push(value),
            "href" => self.references.push(Reference {
                target: value,
                // Which others a browser fetches is not worth telling apart: no page has a reason for them.
                loaded: element == "link",
            }),
            "src" | "poster" | "data" => self.references.push(Reference {
                target: value,
                loaded: true,
            }),
            _ => {}
        }
    }
}

/// Hands every attribute of a tag to `note`; returns what follows the tag.
fn attributes(mut rest: &str, mut note: impl FnMut(&str, &str)) -> &str {
    loop {
        rest = rest.trim_start_matches(|c: char| c.is_whitespace() || c == '/');
        if rest.is_empty() {
            return rest;
        }
        if let Some(after) = rest.strip_prefix('>') {
            return after;
        }
        let ends = |c: char| c.is_whitespace() || c == '=' || c == '>' || c == '/';
        let (name, after) = rest.split_at(rest.find(ends).unwrap_or(rest.len()));
        let Some(value) = after.trim_start().strip_prefix('=') else {
            // An attribute without a value, or a stray sign, which must not stop the reading.
            rest = if name.is_empty() {
                after.strip_prefix('=').unwrap_or(after)
            } else {
                after
            };
            continue;
        };
        let value = value.trim_start();
        let quote = value.chars().next().filter(|c| ['"', '\''].contains(c));
        let (value, after) = if let Some(quote) = quote {
            value[1..].split_once(quote).unwrap_or((&value[1..], ""))
        } else {
            let ends = |c: char| c.is_whitespace() || c == '>';
            value.split_at(value.find(ends).unwrap_or(value.len()))
        };
        note(&name.to_ascii_lowercase(), value);
        rest = after;
    }
}

/// A value without character references, of those that programs write into addresses.
fn unescaped(value: &str) -> String {
    let mut text = value.to_owned();
    for (from, to) in [
        ("&quot;", "\""),
        ("&#39;", "'"),
        ("&#x27;", "'"),
        ("&lt;", "<"),
        ("&gt;", ">"),
        ("&amp;", "&"),
    ] {
        text = text.replace(from, to);
    }
    text
}

/// An address without `%20` and the like.
pub(super) fn decoded(address: &str) -> String {
    let bytes = address.as_bytes();
    let mut out = Vec::with_capacity(bytes.len());
    let mut at = 0;
    while at < bytes.len() {
        let pair = bytes
            .get(at + 1..at + 3)
            .and_then(|pair| std::str::from_utf8(pair).ok());
        let value = pair.and_then(|pair| u8::from_str_radix(pair, 16).ok());
        match (bytes[at], value) {
            (b'%', Some(byte)) => {
                out.push(byte);
                at += 3;
            }
            (byte, _) => {
                out.push(byte);
                at += 1;
            }
        }
    }
    String::from_utf8_lossy(&out).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reference(target: &str, loaded: bool) -> Reference {
        Reference {
            target: target.to_owned(),
            loaded,
        }
    }

    #[test]
    fn references_and_anchors_are_read_however_they_are_quoted() {
        let page = read(
            "<a href=\"x.html#y\" id='z'>a &lt;b href=no&gt;</a><a href=#12 id=12 data-nosnippet>12</a><img src=p.svg/>",
        );
        assert_eq!(page.anchors, ["z", "12"]);
        let expected = [
            reference("x.html#y", false),
            reference("#12", false),
            reference("p.svg/", true),
        ];
        assert_eq!(page.references, expected);
        assert_eq!(
            read("<link rel=\"stylesheet\" href=\"a?b&amp;c\">").references,
            [reference("a?b&c", true)]
        );
    }

    #[test]
    fn scripts_styles_and_comments_are_no_html() {
        let page = read(
            "<script>\"<a href='x'>\"</script><!-- <a href='y'> --><style>a{}</style><a href=\"z\">",
        );
        assert_eq!(page.references, [reference("z", false)]);
    }

    #[test]
    fn a_page_that_leads_on_says_where() {
        let page = read(
            "<meta http-equiv=\"refresh\" content=\"0;URL=../x.html\"><meta name=\"a\" content=\"b\">",
        );
        assert_eq!(page.redirect.as_deref(), Some("../x.html"));
    }

    #[test]
    fn what_is_broken_ends() {
        for text in [
            "<",
            "<a",
            "<a href",
            "<a href=",
            "<a href=\"x",
            "<a = = >",
            "<script>",
            "<!--",
            "<a ==>x",
        ] {
            read(text);
        }
    }

    #[test]
    fn percent_signs_are_decoded() {
        assert_eq!(decoded("a%20b%C3%A9%2"), "a b\u{e9}%2");
    }
}
