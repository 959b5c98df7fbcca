//! `cargo xtask docs`: the guide (mdBook) and the interface of every crate (rustdoc), as one site. It can be opened
//! from the file system or served as it is; it loads nothing from a network.

use crate::cache::write_file;
use crate::process::{run as run_command, shown};
use crate::tools::Tools;
use crate::workspace::{Workspace, remove_folder};
use anyhow::{Context, Result, ensure};
use std::fs;
use std::path::Path;

const BOOK: &str = "docs";
pub(super) const SITE: &str = "target/site";

/// Options of cargo for the complete interface on a machine without libtorch. With one job, no other crate is rendered
/// while cargo has removed a crate's folder, so that every link to its items is there.
pub(super) const ALONE: &str = "--jobs=1 --features ddl-cli/torch,ddl-cli/doc-only";

pub(super) fn print(workspace: &Workspace) -> Result<()> {
    build(workspace, ALONE)?;
    println!("{}", workspace.path(SITE).join("index.html").display());
    Ok(())
}

/// Builds the site and checks its links. The options select the features of another build, so that nothing is compiled
/// twice.
pub(super) fn build(workspace: &Workspace, options: &str) -> Result<()> {
    let (site, made) = (workspace.path(SITE), workspace.path("target/doc"));
    remove_folder(&site)?;
    remove_folder(&made)?;
    // rustdoc links to an item of another crate only if that crate's folder exists.
    for folder in fs::read_dir(workspace.path("crates"))?.flatten() {
        fs::create_dir_all(made.join(module(&folder.file_name().display().to_string())))?;
    }
    // Every warning is an error (`[workspace.lints.rustdoc]`).
    let arguments = format!("doc --workspace --no-deps --quiet --target-dir target {options}");
    run_command(&mut workspace.cargo(arguments.split(' ')))?;
    let tools = Tools::ensure(workspace)?;
    render_book(workspace, &tools, &site.join("guide"))?;
    let api = site.join("api");
    fs::rename(&made, &api).context("the interface cannot be moved to the site")?;
    fs::copy(workspace.path("xtask/landing.html"), site.join("index.html")).context("no first page")?;
    // rustdoc's pages link to a list of crates, which is on the first page of the site.
    redirect(&api.join("index.html"), "../index.html#crates")?;
    lead_out(workspace, &site)?;
    let folders = fs::read_dir(&api)?.flatten();
    let fronts = folders.map(|folder| folder.path().join("index.html"));
    let mut lychee = tools.program(workspace, "lychee");
    lychee.args(["--root-dir".as_ref(), site.as_path(), &site.join("index.html"), &site.join("guide")]);
    run_command(lychee.args(fronts.filter(|page| page.is_file()))).context("links of the site lead nowhere (above)")
}

/// The name of a crate in addresses, from its folder.
fn module(folder: &str) -> String {
    folder.replace('-', "_")
}

/// Renders the book; every warning of mdBook is an error.
fn render_book(workspace: &Workspace, tools: &Tools, out: &Path) -> Result<()> {
    let mut mdbook = tools.program(workspace, "mdbook");
    mdbook.args(["build", BOOK, "--dest-dir"]).arg(out);
    let output = mdbook.output().context("mdbook cannot be started")?;
    let messages = String::from_utf8_lossy(&output.stderr);
    // mdBook continues after most faults and only logs them.
    let is_quiet = !messages.contains("WARN") && !messages.contains("ERROR");
    ensure!(
        output.status.success() && is_quiet,
        "`{}` does not accept the pages:\n{}",
        shown(&mdbook),
        messages.trim()
    );
    Ok(())
}

/// The targets of the book's links to other files of the repository: on the site, the README of a crate is the first
/// page of its interface, and other files are copied.
fn lead_out(workspace: &Workspace, site: &Path) -> Result<()> {
    for page in fs::read_dir(workspace.path(BOOK))?.flatten() {
        let text = fs::read(page.path()).unwrap_or_default();
        let text = String::from_utf8_lossy(&text);
        let links = text.split("](../").skip(1);
        for target in links.filter_map(|rest| rest.split([')', '#']).next()) {
            let of_crate = target.strip_prefix("crates/");
            if let Some(folder) = of_crate.and_then(|rest| rest.strip_suffix("/README.md")) {
                let interface = format!("../../api/{}/index.html", module(folder));
                redirect(&site.join(target).with_extension("html"), &interface)?;
            } else {
                let bytes = fs::read(workspace.path(target)).with_context(|| format!("a page links to {target}"))?;
                write_file(&site.join(target), &bytes)?;
            }
        }
    }
    Ok(())
}

fn redirect(page: &Path, to: &str) -> Result<()> {
    let text = format!(
        "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<title>Moved</title>\n<meta \
         http-equiv=\"refresh\" content=\"0;URL={to}\">\n<a href=\"{to}\">Moved</a>\n</html>\n"
    );
    write_file(page, text.as_bytes())
}

#[cfg(test)]
#[path = "../../../tests/src/console.rs"]
mod console;

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser as _;

    #[test]
    fn every_call_of_this_program_in_the_documentation_is_valid() {
        let workspace = Workspace::find().unwrap();
        let mut calls = 0;
        for page in workspace.files().unwrap() {
            if page.extension().is_none_or(|extension| extension != "md") {
                continue;
            }
            let text = fs::read_to_string(workspace.root.join(&page)).unwrap();
            for command in console::commands(&text) {
                let words = command.words().unwrap_or_default();
                if let ["cargo", "xtask", arguments @ ..] | ["./xtask", arguments @ ..] = words.as_slice() {
                    let call = ["cargo xtask"].iter().chain(arguments);
                    if let Err(error) = crate::Arguments::try_parse_from(call) {
                        panic!("{}:{}: {}\n{error}", page.display(), command.line, command.typed);
                    }
                    calls += 1;
                }
            }
        }
        assert!(calls > 10, "only {calls} calls were found");
        assert!(crate::Arguments::try_parse_from(["cargo xtask", "docs", "--none"]).is_err());
    }
}
