//! A packed model: its configuration alone, or with its networks.

use std::path::PathBuf;

use ddl::{Ddl, DeviceChoice, ModelSource};
use tempfile::TempDir;

use super::packed_file::PackedFile;
use super::{names_file, with_file};

/// The valid files, and the path for edits of them.
struct Sound {
    /// The file without the tensors that only its networks need.
    small: PackedFile,
    whole: PackedFile,
    path: PathBuf,
    _folder: TempDir,
}

impl Sound {
    fn make() -> Self {
        let folder = tempfile::tempdir().expect("a folder can be made");
        let whole = PackedFile::whole();
        Self {
            small: whole.of_few_tensors(),
            whole,
            path: folder.path().join("packed.safetensors"),
            _folder: folder,
        }
    }
}

/// The first byte chooses whether the networks are created as well, which takes most of the time: in one of four cases.
pub fn read(bytes: &[u8]) {
    thread_local! {
        static SOUND: Sound = Sound::make();
    }
    let Some((&first, bytes)) = bytes.split_first() else {
        return;
    };
    SOUND.with(|sound| {
        if first % 4 == 0 {
            read_whole(sound, bytes);
        } else {
            read_config(sound, bytes);
        }
    });
}

fn read_config(sound: &Sound, bytes: &[u8]) {
    let (file, is_sound) = sound.small.edited(bytes);
    let read = with_file(&sound.path, &file, |path| ModelSource::at(path).config());
    if let Err(error) = read {
        assert!(!is_sound, "a valid file: {error}");
        names_file(&error, "packed.safetensors");
    }
}

fn read_whole(sound: &Sound, bytes: &[u8]) {
    let (file, is_sound) = sound.whole.edited(bytes);
    match with_file(&sound.path, &file, |path| Ddl::load(path, DeviceChoice::Cpu)) {
        Ok(model) => {
            let config = model.config();
            assert!(config.star.check().is_ok() && config.goals.check().is_ok());
        }
        Err(error) => {
            assert!(!is_sound, "a valid file: {error}");
            names_file(&error, "packed.safetensors");
        }
    }
}
