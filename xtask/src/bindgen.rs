//! What `cargo xtask web` runs to make JavaScript of a WebAssembly module: `bindgen MODULE PACKAGE PAGE`, the folder of
//! a package of modules with types, and that of one script.

use anyhow::{Result, bail};
use wasm_bindgen_cli_support::Bindgen;

fn main() -> Result<()> {
    let paths: Vec<String> = std::env::args().skip(1).collect();
    let [module, package, page] = paths.as_slice() else {
        bail!("give the module and two folders");
    };
    let bindgen = || {
        let mut bindgen = Bindgen::new();
        bindgen.input_path(module).remove_name_section(true).omit_default_module_path(false);
        bindgen
    };
    bindgen().web(true)?.typescript(true).generate(package)?;
    bindgen().no_modules(true)?.generate(page)
}
