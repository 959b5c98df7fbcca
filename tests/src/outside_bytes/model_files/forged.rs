//! Packed models whose digest is right and whose contents are not: every one is refused, with its path.

use super::{packed_example, smallest_config, with_digest};
use crate::outside_bytes::valid_file::{names_file, with_file};
use crate::safetensors_file;
use ddl::{Ddl, DeviceChoice, ModelSource};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

#[derive(Debug, Clone)]
struct Tensor {
    dtype: Value,
    shape: Vec<u64>,
    bytes: Vec<u8>,
}

/// The parts of a packed model.
#[derive(Debug, Clone)]
struct Parts {
    /// The entry of the header with configuration and digest.
    entry: Value,
    tensors: BTreeMap<String, Tensor>,
}

impl Parts {
    fn of(file: &[u8]) -> Self {
        let (header, numbers) = safetensors_file::parts(file).expect("a valid file");
        let tensor = |(name, tensor): (&String, &Value)| {
            let [start, end]: [usize; 2] = serde_json::from_value(tensor["data_offsets"].clone()).expect("offsets");
            let shape = serde_json::from_value(tensor["shape"].clone()).expect("a shape");
            let (dtype, bytes) = (tensor["dtype"].clone(), numbers[start..end].to_vec());
            (name.clone(), Tensor { dtype, shape, bytes })
        };
        let entry = header["__metadata__"]["ddl"].as_str().expect("an entry");
        let tensors = header.as_object().expect("an object").iter();
        Self {
            entry: serde_json::from_str(entry).expect("an entry is JSON"),
            tensors: tensors
                .filter(|(name, _)| *name != "__metadata__")
                .map(tensor)
                .collect(),
        }
    }

    /// The file of these parts, with their digest.
    fn file(&self) -> Vec<u8> {
        let mut numbers = Vec::new();
        let mut header = Map::new();
        header.insert("__metadata__".to_owned(), json!({ "ddl": self.entry.to_string() }));
        for (name, Tensor { dtype, shape, bytes }) in &self.tensors {
            let start = numbers.len();
            numbers.extend_from_slice(bytes);
            let offsets = [start, numbers.len()];
            header.insert(
                name.clone(),
                json!({ "dtype": dtype, "shape": shape, "data_offsets": offsets }),
            );
        }
        with_digest(&safetensors_file::join(&header.into(), &numbers)).expect("the parts have a digest")
    }

    /// A tensor whose shape is not that of its transpose.
    fn matrix(&mut self) -> &mut Tensor {
        let mut tensors = self.tensors.values_mut();
        let matrix = tensors.find(|tensor| tensor.shape.len() == 2 && tensor.shape[0] != tensor.shape[1]);
        matrix.expect("a model has matrices")
    }

    fn configure(&mut self, pointer: &str, value: Value) {
        let mut config = json!(smallest_config());
        *config.pointer_mut(pointer).expect("a field of the configuration") = value;
        self.entry["config"] = config.to_string().into();
    }
}

type Edit = fn(&mut Parts);

const EDITS: [(&str, Edit); 15] = [
    ("without one tensor", |parts| drop(parts.tensors.pop_first())),
    ("without tensors", |parts| parts.tensors.clear()),
    ("a tensor too many", |parts| {
        let twin = parts.matrix().clone();
        parts.tensors.insert("network.twin".to_owned(), twin);
    }),
    ("transposed", |parts| parts.matrix().shape.reverse()),
    ("one more axis", |parts| parts.matrix().shape.push(1)),
    ("huge shape", |parts| parts.matrix().shape = vec![1 << 62, 1 << 62]),
    ("another size", |parts| {
        let matrix = parts.matrix();
        (matrix.shape, matrix.bytes) = (vec![3], vec![0; 6]);
    }),
    ("not finite", |parts| {
        parts.matrix().bytes[..2].copy_from_slice(&0x7e00_u16.to_le_bytes());
    }),
    ("wider network", |parts| {
        parts.configure("/star/feed_forward_width", json!(2));
    }),
    ("huge network", |parts| {
        parts.configure("/star/model_width", json!(1_u64 << 40));
    }),
    ("huge proposal", |parts| {
        parts.configure("/goals/proposal/network/width", json!(1_u64 << 40));
    }),
    ("negative width", |parts| {
        parts.configure("/star/model_width", json!(-1));
    }),
    ("null", |parts| parts.configure("/star", Value::Null)),
    ("configuration not JSON", |parts| parts.entry["config"] = "{".into()),
    ("another layout", |parts| parts.entry["layout"] = json!(99)),
];

#[test]
fn a_packed_model_with_wrong_contents_and_a_right_digest_is_refused() {
    let folder = tempfile::tempdir().expect("a folder can be made");
    let path = folder.path().join("packed.safetensors");
    packed_example(&path);
    let whole = std::fs::read(&path).expect("the file was written");
    let parts = Parts::of(&whole);
    let numbers = safetensors_file::parts(&whole).expect("a valid file").1.len();
    let load = |file: &[u8]| with_file(&path, file, |path| Ddl::load(path, DeviceChoice::Cpu));
    assert!(load(&parts.file()).is_ok(), "without an edit the parts are a model");
    let edited = EDITS.map(|(name, edit)| {
        let mut edited = parts.clone();
        edit(&mut edited);
        (name, edited.file())
    });
    let damaged = [
        ("huge header", [&u64::MAX.to_le_bytes()[..], &whole[8..]].concat()),
        ("header alone", whole[..whole.len() - numbers].to_vec()),
        ("longer", [&whole[..], b"\0"].concat()),
    ];
    for (name, file) in edited.into_iter().chain(damaged) {
        let error = load(&file).err().unwrap_or_else(|| panic!("{name} was accepted"));
        eprintln!("{name}: {error}");
        names_file(&error, "packed.safetensors");
        // The configuration alone may be valid.
        if let Err(error) = with_file(&path, &file, |path| ModelSource::at(path).config()) {
            names_file(&error, "packed.safetensors");
        }
    }
}
