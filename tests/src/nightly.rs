//! The number of repetitions: few in a usual run of the tests, many with the environment variable `DDL_NIGHTLY`.

/// `many` if `DDL_NIGHTLY` is set, otherwise `few`.
pub fn rounds<T>(few: T, many: T) -> T {
    let is_nightly = std::env::var_os("DDL_NIGHTLY").is_some_and(|value| !value.is_empty());
    if is_nightly { many } else { few }
}
