//! The committed header is what cbindgen makes of the sources. With `DDL_WRITE_HEADER=1` it is made anew.

use std::path::Path;

#[test]
fn the_header_is_that_of_the_sources() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let recipe = cbindgen::Config::from_file(folder.join("cbindgen.toml")).unwrap();
    let sources = cbindgen::Builder::new().with_config(recipe);
    let sources = sources.with_src(folder.join("src/layout.rs")).with_src(folder.join("src/handles.rs"));
    let mut made = Vec::new();
    let header = sources.with_src(folder.join("src/functions.rs")).generate().unwrap();
    header.write(&mut made);
    let path = folder.join("include/ddl.h");
    if std::env::var_os("DDL_WRITE_HEADER").is_some() {
        std::fs::write(&path, &made).unwrap();
    }
    let committed = std::fs::read(&path).unwrap();
    assert!(committed == made, "include/ddl.h is old: DDL_WRITE_HEADER=1 cargo test -p ddl-c --test header");
}
