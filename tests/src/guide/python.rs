//! The Python of a page, run as a reader would run it.

use crate::page_run::PageFolder;
use crate::python_packages;

/// Looks at the picture that a page draws, as its text says: black tracks, orange hypotheses, green goals.
const LOOK: &str = "
import matplotlib.image
picture = matplotlib.image.imread('forecasts.png')[..., :3]
orange = (picture - [1.0, 0.5, 0.05] < 0.1).all(axis=-1) & (picture[..., 0] - picture[..., 2] > 0.5)
green = (picture[..., 1] - picture[..., 0] > 0.2) & (picture[..., 1] - picture[..., 2] > 0.2)
black = (picture < 0.1).all(axis=-1)
shares = {'orange': orange.mean(), 'green': green.mean(), 'black': black.mean()}
assert all(share > 0.002 for share in shares.values()), shares
";

pub(super) fn run(page: &str, text: &str, folder: &PageFolder) {
    let mut blocks = text
        .split("```python\n")
        .skip(1)
        .map(|rest| rest.split("```").next().unwrap_or_default())
        .peekable();
    if blocks.peek().is_none() {
        return;
    }
    let Some(packages) = python_packages::ensure() else {
        return;
    };
    let written: String = blocks.collect::<Vec<_>>().join("\n") + LOOK;
    std::fs::write(folder.path().join("page.py"), written).unwrap();
    let output = std::process::Command::new("python3")
        .arg("page.py")
        .current_dir(folder.path())
        .env("PYTHONPATH", packages)
        .env("MPLBACKEND", "Agg")
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{page}: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    if let Some(to) = std::env::var_os("DDL_PAGE_PICTURE") {
        std::fs::copy(folder.path().join("forecasts.png"), to).unwrap();
    }
}
