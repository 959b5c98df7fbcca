//! Choosing device and threads of a process.

use ddl::DeviceChoice;
use ddl_tests::tiny_model;

/// A program that embeds the library may ask again, also when tensors are at work already: that is
/// answered, and not a panic out of libtorch.
#[test]
fn device_and_threads_may_be_chosen_again() {
    tiny_model::use_one_thread();
    for _ in 0..2 {
        ddl::prepare(DeviceChoice::Cpu, Some(1)).unwrap();
    }
}
