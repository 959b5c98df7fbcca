//! The references and anchors of a page.

use std::collections::BTreeSet;

use html5gum::{DefaultEmitter, Token, Tokenizer};

#[derive(Debug)]
pub(super) struct Reference {
    pub(super) target: String,
    /// Whether the browser loads it automatically, as a picture or a style.
    pub(super) loaded: bool,
}

#[derive(Debug, Default)]
pub(super) struct Page {
    pub(super) references: Vec<Reference>,
    pub(super) anchors: BTreeSet<String>,
    pub(super) redirect: Option<String>,
}

impl Page {
    pub(super) fn read(html: &str) -> Self {
        let mut page = Self::default();
        let mut emitter = DefaultEmitter::default();
        emitter.naively_switch_states(true); // scripts and styles are not HTML
        for Ok(token) in Tokenizer::new_with_emitter(html, emitter) {
            let Token::StartTag(tag) = token else {
                continue;
            };
            for (name, value) in &tag.attributes {
                let value = String::from_utf8_lossy(value).into_owned();
                page.note(&tag.name, name, value);
            }
        }
        page
    }

    fn note(&mut self, element: &[u8], attribute: &[u8], value: String) {
        match (element, attribute) {
            (_, b"id") | (b"a", b"name") => {
                self.anchors.insert(value);
            }
            (b"meta", b"content") => {
                let target = value.split_once(";URL=").map(|(_, target)| target.to_owned());
                self.redirect = self.redirect.take().or(target);
            }
            (b"link", b"href") | (_, b"src" | b"poster" | b"data") => {
                self.references.push(Reference {
                    target: value,
                    loaded: true,
                });
            }
            (_, b"href") => self.references.push(Reference {
                target: value,
                loaded: false,
            }),
            _ => {}
        }
    }
}
