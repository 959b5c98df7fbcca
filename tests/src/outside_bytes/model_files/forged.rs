//! Packed models whose digest is right and whose contents are not: every one is refused, with its path. `ddl-network`
//! tests tensors that are missing, too many, of another size or not finite.

use super::{packed_example, smallest_config, with_digest};
use crate::outside_bytes::valid_file::{names_file, with_file};
use crate::safetensors_file::{join, parts};
use ddl::{Ddl, DeviceChoice, ModelSource};
use serde_json::{Value, json};

/// Fields of the configuration, and other values of them.
const CONFIGURATIONS: [(&str, &str); 5] = [
    ("/star/feed_forward_width", "2"),
    ("/star/model_width", "1099511627776"),
    ("/goals/proposal/network/width", "1099511627776"),
    ("/star/model_width", "-1"),
    ("/star", "null"),
];

/// The shape of a tensor that is not that of its transpose.
fn matrix(header: &mut Value) -> &mut Vec<Value> {
    let tensors = header.as_object_mut().expect("an object").values_mut();
    let mut shapes = tensors.filter_map(|tensor| tensor.get_mut("shape")?.as_array_mut());
    shapes.find(|shape| shape.len() == 2 && shape[0] != shape[1]).expect("a model has matrices")
}

#[test]
fn a_packed_model_with_wrong_contents_and_a_right_digest_is_refused() {
    let folder = tempfile::tempdir().expect("a folder can be made");
    let path = folder.path().join("packed.safetensors");
    packed_example(&path);
    let whole = std::fs::read(&path).expect("the file was written");
    let (header, numbers) = parts(&whole).expect("a valid file");
    let written = |header: &Value, numbers: &[u8]| with_digest(&join(header, numbers)).expect("a digest");
    let load = |file: &[u8]| with_file(&path, file, |path| Ddl::load(path, DeviceChoice::Cpu));
    assert!(load(&written(&header, numbers)).is_ok(), "without an edit it is a model");
    let shaped = |edit: fn(&mut Vec<Value>)| {
        let mut header = header.clone();
        edit(matrix(&mut header));
        written(&header, numbers)
    };
    let entry = header["__metadata__"]["ddl"].as_str().expect("an entry");
    let with = |field: &str, value: Value| {
        let mut entry: Value = serde_json::from_str(entry).expect("an entry is JSON");
        entry[field] = value;
        let mut header = header.clone();
        header["__metadata__"]["ddl"] = entry.to_string().into();
        written(&header, numbers)
    };
    let configured = CONFIGURATIONS.map(|(pointer, value)| {
        let mut config = json!(smallest_config());
        *config.pointer_mut(pointer).expect("a field of the configuration") = value.parse().expect("JSON");
        (pointer, with("config", config.to_string().into()))
    });
    let without_tensors = json!({ "__metadata__": header["__metadata__"] });
    let damaged = [
        ("transposed", shaped(|shape| shape.reverse())),
        ("huge shape", shaped(|shape| shape.fill(json!(1_u64 << 62)))),
        ("configuration not JSON", with("config", "{".into())),
        ("another layout", with("layout", json!(99))),
        ("without tensors", written(&without_tensors, &[])),
        ("huge header", [&u64::MAX.to_le_bytes()[..], &whole[8..]].concat()),
        ("header alone", whole[..whole.len() - numbers.len()].to_vec()),
        ("longer", [&whole[..], b"\0"].concat()),
    ];
    for (name, file) in configured.into_iter().chain(damaged) {
        let error = load(&file).err().unwrap_or_else(|| panic!("{name} was accepted"));
        eprintln!("{name}: {error}");
        names_file(&error, "packed.safetensors");
        // The configuration alone may be valid.
        if let Err(error) = with_file(&path, &file, |path| ModelSource::at(path).config()) {
            names_file(&error, "packed.safetensors");
        }
    }
}
