//! Names the shared library for the loader of Linux: before 1.0 each minor version has an interface of its own.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    if std::env::var("CARGO_CFG_TARGET_OS").as_deref() == Ok("linux") {
        let [major, minor] = [env!("CARGO_PKG_VERSION_MAJOR"), env!("CARGO_PKG_VERSION_MINOR")];
        println!("cargo::rustc-cdylib-link-arg=-Wl,-soname,libddl.so.{major}.{minor}");
    }
}
