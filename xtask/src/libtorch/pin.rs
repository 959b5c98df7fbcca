//! The pinned libtorch: one version, three wheels, and the files needed from them. These are the CPU libraries, and
//! CUDA's runtime and profiling libraries, which the wheel's libraries need to load.

/// Version of libtorch that the binding in `Cargo.lock` requires.
pub(crate) const VERSION: &str = "2.11.0";

/// Version of the binding; a test checks that the two agree.
#[cfg(test)]
const BINDING_VERSION: &str = "0.24.0";

/// Python version of the wheel to fetch. The libraries in it do not depend on Python, so any Python 3 can fetch it.
pub(super) const PYTHON_VERSION: &str = "3.11";

/// Platform tags of the three wheels.
pub(super) const PLATFORMS: [&str; 4] = [
    "manylinux_2_28_x86_64",
    "manylinux_2_25_x86_64",
    "manylinux_2_17_x86_64",
    "manylinux2014_x86_64",
];

/// A package file and the members used from it.
#[derive(Debug)]
pub(super) struct Wheel {
    /// The requirement passed to pip.
    pub(super) requirement: &'static str,
    pub(super) file: &'static str,
    pub(super) sha256: &'static str,
    pub(super) bytes: u64,
    /// `FROM=TO`; a `FROM` ending in a slash is a tree.
    pub(super) members: &'static [&'static str],
}

pub(super) const WHEELS: [Wheel; 3] = [
    Wheel {
        requirement: "torch==2.11.0",
        file: "torch-2.11.0-cp311-cp311-manylinux_2_28_x86_64.whl",
        sha256: "7aa2f9bbc6d4595ba72138026b2074be1233186150e9292865e04b7a63b8c67a",
        bytes: 530_604_548,
        members: &[
            "torch/include/=include/",
            "torch/lib/libtorch_cpu.so=lib/libtorch_cpu.so",
            "torch/lib/libc10.so=lib/libc10.so",
            "torch/lib/libgomp.so.1=lib/libgomp.so.1",
            "torch-2.11.0.dist-info/licenses/=licenses/torch/",
        ],
    },
    Wheel {
        requirement: "nvidia-cuda-runtime==13.0.96",
        file: "nvidia_cuda_runtime-13.0.96-py3-none-manylinux2014_x86_64.manylinux_2_17_x86_64.whl",
        sha256: "7f82250d7782aa23b6cfe765ecc7db554bd3c2870c43f3d1821f1d18aebf0548",
        bytes: 2_243_632,
        members: &[
            "nvidia/cu13/lib/libcudart.so.13=lib/libcudart.so.13",
            "nvidia_cuda_runtime-13.0.96.dist-info/licenses/=licenses/cuda-runtime/",
        ],
    },
    Wheel {
        requirement: "nvidia-cuda-cupti==13.0.85",
        file: "nvidia_cuda_cupti-13.0.85-py3-none-manylinux_2_25_x86_64.whl",
        sha256: "4eb01c08e859bf924d222250d2e8f8b8ff6d3db4721288cf35d14252a4d933c8",
        bytes: 10_715_597,
        members: &[
            "nvidia/cu13/lib/libcupti.so.13=lib/libcupti.so.13",
            "nvidia_cuda_cupti-13.0.85.dist-info/licenses/=licenses/cuda-cupti/",
        ],
    },
];

/// Disk space of the unpacked libraries in bytes (495 MB measured), with a margin.
pub(super) const LAID_OUT_BYTES: u64 = 560_000_000;

/// Name of the folder in a cache, which may hold several versions.
pub(super) fn folder_name() -> String {
    format!("libtorch-{VERSION}")
}

pub(super) fn is_supported() -> bool {
    cfg!(all(target_os = "linux", target_arch = "x86_64", target_env = "gnu"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::workspace::Workspace;

    /// The binding's build script fixes the libtorch version that it requires.
    #[test]
    fn the_locked_binding_is_the_one_this_libtorch_is_for() {
        let lock = std::fs::read_to_string(Workspace::find().unwrap().path("Cargo.lock")).unwrap();
        let lock: toml::Table = lock.parse().unwrap();
        for name in ["tch", "torch-sys"] {
            let versions: Vec<&str> = lock["package"]
                .as_array()
                .unwrap()
                .iter()
                .filter(|package| package["name"].as_str() == Some(name))
                .map(|package| package["version"].as_str().unwrap())
                .collect();
            assert_eq!(versions, [BINDING_VERSION], "{name}");
        }
    }

    /// The fetched version is the one that runs record as their libtorch.
    #[test]
    fn the_version_that_runs_record_is_the_pinned_one() {
        let device = Workspace::find().unwrap().path("crates/ddl-star/src/device.rs");
        let text = std::fs::read_to_string(device).unwrap();
        assert_eq!(WHEELS[0].requirement, format!("torch=={VERSION}"));
        assert!(text.contains(&format!("LIBTORCH_VERSION: &str = \"{VERSION}\"")));
    }
}
