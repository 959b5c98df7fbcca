#![doc = include_str!("../README.md")]

mod answer;
mod boundary;
pub mod functions;
pub mod handles;
pub mod layout;
mod live;
mod model;
#[cfg(test)]
mod tests;

#[cfg(feature = "pool")]
#[global_allocator]
static POOL: rlsf::GlobalTlsf = rlsf::GlobalTlsf::new();
