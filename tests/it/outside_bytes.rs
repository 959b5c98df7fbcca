//! Every reader of outside bytes that needs no libtorch, with its corpus.

use ddl_tests::outside_bytes::{READERS, corpus};

#[test]
fn readers_keep_their_laws_on_their_corpora_and_what_is_made_of_them() {
    for reader in READERS {
        corpus::run(reader);
    }
}
