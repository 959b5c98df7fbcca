//! Where the tests find real recordings.
