//! Tests of which folders are trusted, and of the files left by a failed set-up.

use super::*;

/// A folder with the members of the wheels, with a few bytes in each library.
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
fn only_complete_folders_of_the_pinned_wheels_are_trusted() {
    let folder = laid_out();
    let at = |file: &str| folder.path().join(file);
    let is_trusted = || is_complete(folder.path());
    assert!(!is_trusted());
    finish(folder.path()).unwrap();
    assert!(is_trusted());
    verify(folder.path()).unwrap();

    let library = at("lib/libc10.so");
    let whole = fs::read(&library).unwrap();
    // Other contents of the same size are detected only by their hash.
    fs::write(&library, "LIB/LIBC10.SO").unwrap();
    assert!(is_trusted());
    let message = format!("{:#}", verify(folder.path()).unwrap_err());
    assert!(
        message.contains("libc10.so") && message.contains("wrong contents"),
        "{message}"
    );
    fs::write(&library, "cut").unwrap();
    assert!(!is_trusted());
    fs::remove_file(&library).unwrap();
    assert!(!is_trusted());

    fs::write(&library, whole).unwrap();
    let mark = fs::read_to_string(at(MARK)).unwrap();
    let of_others = mark.replace(WHEELS[0].sha256, WHEELS[1].sha256);
    for damaged in [&of_others, &mark[..mark.len() / 2]] {
        fs::write(at(MARK), damaged).unwrap();
        assert!(!is_trusted());
    }
    fs::write(at(MARK), mark).unwrap();
    assert!(is_trusted());
}

#[test]
fn missing_and_wrong_wheels_are_reported_and_nothing_is_left() {
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
    assert!(message.contains("ended after 12 of 530604548 bytes"), "{message}");
    assert_eq!(fs::read_dir(cache.path()).unwrap().count(), 0);
}
