//! Paths among the options, by what a command does with them, so that none writes over what it reads. A plain path is
//! an input.

use clap::builder::{MapValueParser, PathBufValueParser, TypedValueParser as _, ValueParserFactory};
use std::ops::Deref;
use std::path::{Path, PathBuf};

macro_rules! path {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Debug, Clone)]
        pub(crate) struct $name(PathBuf);

        // As of every path, an empty one is refused.
        impl ValueParserFactory for $name {
            type Parser = MapValueParser<PathBufValueParser, fn(PathBuf) -> Self>;

            fn value_parser() -> Self::Parser {
                PathBufValueParser::new().map(Self)
            }
        }

        impl From<$name> for PathBuf {
            fn from(path: $name) -> Self {
                path.0
            }
        }

        impl AsRef<Path> for $name {
            fn as_ref(&self) -> &Path {
                self
            }
        }

        impl Deref for $name {
            type Target = Path;

            fn deref(&self) -> &Path {
                &self.0
            }
        }
    };
}

path! {
    /// A text that is written: a file in a folder that exists, or `-` for standard output.
    OutputFile
}
path! {
    /// A file that is no text, or a folder, which is written.
    OutputPlace
}
path! {
    /// A model: a run, whose files are also written, a packed file, or a built-in name.
    ModelPath
}
path! {
    /// The memory of a place, which is read and written.
    MemoryPath
}
