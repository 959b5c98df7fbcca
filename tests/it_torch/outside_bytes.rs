//! Every reader of model files, with its corpus.

use ddl_tests::outside_bytes::{TORCH_READERS, corpus};

#[test]
fn readers_of_models_keep_their_laws_on_their_corpora_and_what_is_made_of_them() {
    for reader in TORCH_READERS {
        corpus::run(reader);
    }
}
