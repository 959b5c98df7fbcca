//! What is trusted, what is not, and what a failed set-up leaves behind.

use super::*;

/// A folder as the wheels' members would leave it, with a few bytes in each library.
fn laid_out() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("lib")).unwrap();
    for rule in WHEELS.iter().flat_map(|wheel| wheel.members) {
        let (_, file) = rule.split_once('=').unwrap();
        if file.starts_with("lib/") {
            fs::write(folder.path().join(file), file).unwrap();
        }
    }
    folder
}

#[test]
fn only_a_finished_folder_is_trusted() {
    let folder = laid_out();
    assert!(!is_complete(folder.path()));
    finish(folder.path()).unwrap();
    assert!(is_complete(folder.path()));
    verify(folder.path()).unwrap();
}

#[test]
fn a_missing_or_cut_library_is_seen() {
    let folder = laid_out();
    finish(folder.path()).unwrap();
    fs::write(folder.path().join("lib/libc10.so"), "cut").unwrap();
    assert!(!is_complete(folder.path()));
    fs::remove_file(folder.path().join("lib/libc10.so")).unwrap();
    assert!(!is_complete(folder.path()));
}

#[test]
fn a_library_with_other_contents_of_the_same_size_is_found_by_its_hash() {
    let folder = laid_out();
    finish(folder.path()).unwrap();
    fs::write(folder.path().join("lib/libc10.so"), "LIB/LIBC10.SO").unwrap();
    assert!(is_complete(folder.path()));
    let message = format!("{:#}", verify(folder.path()).unwrap_err());
    assert!(
        message.contains("libc10.so") && message.contains("wrong contents"),
        "{message}"
    );
}

#[test]
fn a_mark_of_other_wheels_or_a_damaged_one_is_not_trusted() {
    let folder = laid_out();
    finish(folder.path()).unwrap();
    let mark = folder.path().join(MARK);
    let text = fs::read_to_string(&mark).unwrap();
    fs::write(&mark, text.replace(WHEELS[0].sha256, WHEELS[1].sha256)).unwrap();
    assert!(!is_complete(folder.path()));
    fs::write(&mark, &text[..text.len() / 2]).unwrap();
    assert!(!is_complete(folder.path()));
}

#[test]
fn missing_and_wrong_wheels_are_named_and_nothing_is_left() {
    if !pin::is_supported() {
        return; // nothing is fetched on such a platform
    }
    let cache = tempfile::tempdir().unwrap();
    let wheels = tempfile::tempdir().unwrap();
    let folder = cache.path().join("libtorch");
    let message = format!("{:#}", fetch(&folder, Some(wheels.path())).unwrap_err());
    assert!(
        message.contains(WHEELS[0].file) && message.contains("missing"),
        "{message}"
    );
    fs::write(wheels.path().join(WHEELS[0].file), "half a wheel").unwrap();
    let message = format!("{:#}", fetch(&folder, Some(wheels.path())).unwrap_err());
    assert!(
        message.contains("ended after 12 of 530604548 bytes"),
        "{message}"
    );
    assert_eq!(fs::read_dir(cache.path()).unwrap().count(), 0);
}
