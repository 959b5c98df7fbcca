//! No command may write over what it reads: one guard for all options, by the types of their paths.

use crate::paths::{MemoryPath, ModelPath, OutputFile, OutputPlace};
use crate::recordings::EXTENSIONS;
use anyhow::{bail, ensure};
use clap::{ArgMatches, Command};
use ddl::RunDirectory;
use ddl::data::{Convention, locate};
use std::ops::Deref;
use std::path::{Path, PathBuf};

/// Names of files that commands write into the folder of `--out`, beside those of a run.
const WRITTEN: [&str; 3] = ["plan.json", "report.html", "report.md"];

/// What a command does with a path.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Use {
    Input,
    OutputFile,
    OutputPlace,
    Model,
    Memory,
}

/// A path among the arguments, with the name of its option as users type it.
struct NamedPath {
    option: String,
    path: PathBuf,
    purpose: Use,
}

/// The paths of an argument; none for other arguments.
fn paths_of(matches: &ArgMatches, id: &str) -> Vec<(Use, PathBuf)> {
    fn typed<P: Deref<Target = Path> + Clone + Send + Sync + 'static>(matches: &ArgMatches, id: &str) -> Vec<PathBuf> {
        // An error for arguments of another type.
        matches.try_get_many::<P>(id).ok().flatten().into_iter().flatten().map(|path| path.to_path_buf()).collect()
    }
    let kinds = [
        (Use::Input, typed::<PathBuf>(matches, id)),
        (Use::OutputFile, typed::<OutputFile>(matches, id)),
        (Use::OutputPlace, typed::<OutputPlace>(matches, id)),
        (Use::Model, typed::<ModelPath>(matches, id)),
        (Use::Memory, typed::<MemoryPath>(matches, id)),
    ];
    kinds.into_iter().flat_map(|(purpose, paths)| paths.into_iter().map(move |path| (purpose, path))).collect()
}

/// Refuses arguments whose output would replace one of their inputs, also through links, or cannot be written.
///
/// # Errors
/// Names the options and the file or folder.
pub(crate) fn ensure_kept(command: &Command, matches: &ArgMatches) -> anyhow::Result<()> {
    let Some((name, matches)) = matches.subcommand() else {
        return Ok(());
    };
    let command = command.find_subcommand(name).into_iter();
    let (mut outputs, mut inputs) = (Vec::new(), Vec::new());
    for argument in command.flat_map(Command::get_arguments) {
        let id = argument.get_id().as_str();
        let named = argument.get_value_names().and_then(<[_]>::first);
        let option = argument.get_long().map(|long| format!("--{long}"));
        let option = option.unwrap_or_else(|| named.map_or_else(|| id.to_uppercase(), ToString::to_string));
        for (purpose, path) in paths_of(matches, id) {
            // `-` is standard input or output.
            let is_standard = path == Path::new("-");
            let is_text = !matches!(purpose, Use::OutputPlace | Use::Memory);
            ensure!(!is_standard || is_text, "{option} - is no path: give that of a file or folder");
            if !is_standard {
                let is_output = matches!(purpose, Use::OutputFile | Use::OutputPlace);
                let side = if is_output { &mut outputs } else { &mut inputs };
                side.push(NamedPath { option: option.clone(), path, purpose });
            }
        }
    }
    inputs.extend(standing_inputs(matches));
    for output in &outputs {
        // Said before the work.
        if output.purpose == Use::OutputFile
            && let Some(folder) = output.path.parent()
            && !folder.as_os_str().is_empty()
            && !folder.is_dir()
        {
            bail!("{}: the folder {} does not exist; create it first", output.option, folder.display());
        }
        if ["evaluate", "report", "benchmark"].contains(&name) {
            ensure_no_other_run(output, &inputs)?;
        }
        for input in &inputs {
            // A report reads the results in the folders of runs. Other commands add to a run.
            let of_report = name == "report" && output.path.is_dir() && place(&output.path) == place(&input.path);
            let lost = lost(&output.path, input).or_else(|| of_report.then(|| input.path.clone()));
            if let Some(lost) = lost {
                bail!(
                    "{} is an input ({}) and would be lost; give another {}",
                    lost.display(),
                    input.option,
                    output.option
                );
            }
        }
    }
    Ok(())
}

/// Refuses the folder of a run that is no input: its results would be replaced by others.
fn ensure_no_other_run(output: &NamedPath, inputs: &[NamedPath]) -> anyhow::Result<()> {
    let holds = |file: &&str| output.path.join(file).is_file();
    let weights = ["model.safetensors", "proposal.safetensors", "experts.safetensors"];
    let is_run = holds(&"config.json") && weights.iter().any(holds);
    let here = place(&output.path);
    let is_of_it = |input: &NamedPath| {
        let there = place(&input.path);
        let folder = there.as_deref().and_then(Path::parent);
        input.purpose == Use::Model && (there == here || folder == here.as_deref())
    };
    ensure!(
        !is_run || inputs.iter().any(is_of_it),
        "{} is the folder of a run, whose results would be replaced; give another {}",
        output.path.display(),
        output.option
    );
    Ok(())
}

/// Inputs that no argument names: the recordings that are read by default, and the file that standard input reads.
fn standing_inputs(matches: &ArgMatches) -> impl Iterator<Item = NamedPath> {
    let is_default = matches.try_contains_id("data").is_ok_and(|is_given| !is_given);
    let conventions = Convention::ALL.into_iter().filter(move |_| is_default);
    let folders = conventions.filter_map(|convention| locate(convention, None).ok());
    let folders = folders.map(|folder| ("the recordings of ETH/UCY", folder));
    let standard = Some(PathBuf::from("/dev/stdin")).filter(|standard| standard.is_file());
    let inputs = folders.chain(standard.map(|path| ("standard input", path)));
    inputs.map(|(option, path)| NamedPath { option: option.to_owned(), path, purpose: Use::Input })
}

/// The input that writing to `output` would replace.
fn lost(output: &Path, NamedPath { path: input, purpose, .. }: &NamedPath) -> Option<PathBuf> {
    let (there, here) = (place(output)?, place(input)?);
    let ends = |path: &Path, kinds: &[&str]| kinds.iter().any(|&kind| path.extension().is_some_and(|it| it == kind));
    let replaced = if output.is_dir() {
        // Recordings have other names, and may lie in the folder of the results. Grids are named by their frames.
        here.parent() == Some(&*there) && (is_written(&here) || ends(&here, &["npy", "pgm", "yaml"]))
    } else if output.is_file() {
        let is_read = if *purpose == Use::Model {
            // A packed model may be kept beside the files of its run.
            is_written(&there) || there.parent() == Some(&*here.join("epochs"))
        } else {
            // Recordings also lie in folders of folders.
            let extension = there.extension().and_then(std::ffi::OsStr::to_str);
            let mut kinds = EXTENSIONS.iter().chain(&["memory", "db3"]);
            // That of a rosbag2 recording names its files.
            let is_bag = there.ends_with("metadata.yaml");
            is_bag || extension.is_some_and(|it| kinds.any(|kind| it.eq_ignore_ascii_case(kind)))
        };
        there == here || (is_read && there.starts_with(&here)) || is_same_file(output, input)
    } else {
        // Nothing is there yet, but both would be written: the memory, or one of a scene in its folder.
        let of_scene = there.parent() == Some(&*here) && ends(&there, &["memory", "lock"]);
        *purpose == Use::Memory && (there == here || of_scene)
    };
    // Not `/dev/stdin`.
    let is_named = input.is_file() && output.is_dir();
    replaced.then(|| if is_named { input } else { output }.to_owned())
}

fn is_written(file: &Path) -> bool {
    let name = file.file_name().and_then(std::ffi::OsStr::to_str);
    name.is_some_and(|name| WRITTEN.contains(&name) || RunDirectory::FILES.contains(&name))
}

/// The absolute path without links; the last part need not exist.
fn place(path: &Path) -> Option<PathBuf> {
    path.canonicalize().ok().or_else(|| {
        let folder = match path.parent()? {
            folder if folder.as_os_str().is_empty() => Path::new("."),
            folder => folder,
        };
        Some(folder.canonicalize().ok()?.join(path.file_name()?))
    })
}

#[cfg(unix)]
fn is_same_file(one: &Path, two: &Path) -> bool {
    use std::os::unix::fs::MetadataExt as _;
    let identity = |path: &Path| {
        let of_file = path.metadata().ok().filter(std::fs::Metadata::is_file)?;
        Some((of_file.dev(), of_file.ino()))
    };
    identity(one).is_some_and(|it| Some(it) == identity(two))
}

#[cfg(not(unix))]
fn is_same_file(_: &Path, _: &Path) -> bool {
    false
}
