//! No command may write over what it reads: one guard for all options that name a file or folder.

use anyhow::bail;
use clap::{Arg, ArgMatches, Command};
use std::any::TypeId;
use std::path::{Path, PathBuf};

/// Options whose file or folder is written.
const OUTPUTS: [&str; 4] = ["output", "out", "svg", "folder"];

/// Names of files that commands write into the folder of `--out`.
const WRITTEN: [&str; 11] = [
    "config.json",
    "metrics.jsonl",
    "moments.json",
    "plan.json",
    "report.html",
    "report.json",
    "report.md",
    "report.tex",
    "model.safetensors",
    "optimizer.safetensors",
    "experts.safetensors",
];

/// A path among the arguments, with the name of its option as users type it.
struct Named<'a> {
    option: String,
    path: &'a Path,
}

/// Refuses arguments whose output would replace one of their inputs, also through links.
///
/// # Errors
/// Names both options and the file.
pub(crate) fn ensure_kept(command: &Command, matches: &ArgMatches) -> anyhow::Result<()> {
    let Some((name, matches)) = matches.subcommand() else {
        return Ok(());
    };
    let arguments = command
        .find_subcommand(name)
        .into_iter()
        .flat_map(Command::get_arguments);
    let (outputs, inputs): (Vec<&Arg>, Vec<&Arg>) = arguments.partition(|argument| is_output(argument));
    let named = |arguments: Vec<&Arg>| -> Vec<Named<'_>> {
        let paths = arguments.into_iter().flat_map(|argument| paths(argument, matches));
        paths.collect()
    };
    let (outputs, mut inputs) = (named(outputs), named(inputs));
    let default = std::env::var_os("DDL_DATASETS").map(PathBuf::from);
    inputs.extend(default.as_deref().map(|path| Named {
        option: "DDL_DATASETS".into(),
        path,
    }));
    // The file that standard input reads.
    let standard = Path::new("/dev/stdin");
    if standard.is_file() {
        inputs.push(Named {
            option: "standard input".into(),
            path: standard,
        });
    }
    for output in &outputs {
        for input in &inputs {
            // A report reads the results in the folders of runs. Other commands add to a run.
            let of_report = name == "report" && place(output.path) == place(input.path);
            let lost = lost(output.path, input).or_else(|| of_report.then(|| input.path.to_owned()));
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
    if let Some([one, two]) = same(&outputs) {
        bail!("{one} and {two} name the same file; give another {two}");
    }
    Ok(())
}

fn is_output(argument: &Arg) -> bool {
    OUTPUTS.contains(&argument.get_id().as_str())
}

fn paths<'a>(argument: &Arg, matches: &'a ArgMatches) -> Vec<Named<'a>> {
    if argument.get_value_parser().type_id() != TypeId::of::<PathBuf>() {
        return Vec::new();
    }
    let option = if let Some(long) = argument.get_long() {
        format!("--{long}")
    } else {
        let names = argument.get_value_names().and_then(<[_]>::first);
        names.map_or_else(|| argument.get_id().to_string().to_uppercase(), ToString::to_string)
    };
    let given = matches.try_get_many::<PathBuf>(argument.get_id().as_str());
    // `-` is standard input or output.
    let given = given.ok().flatten().into_iter().flatten();
    let given = given.filter(|path| *path != Path::new("-"));
    given
        .map(|path| Named {
            option: option.clone(),
            path,
        })
        .collect()
}

/// The input that writing to `output` would replace.
fn lost(output: &Path, Named { option, path: input }: &Named<'_>) -> Option<PathBuf> {
    let (there, here) = (place(output)?, place(input)?);
    let is_written = |file: &Path| {
        WRITTEN
            .iter()
            .any(|name| file.file_name().is_some_and(|it| it == *name))
    };
    let replaced = if output.is_dir() {
        // Recordings have other names, and may lie in the folder of the results.
        here.parent() == Some(&*there) && is_written(&here)
    } else if output.is_file() {
        // A packed model may be kept beside the files of its run.
        let of_run = ["--model", "--from", "--benchmark"].contains(&option.as_str());
        let read = if of_run { is_written(&there) } else { !is_result(&there) };
        let inside = there.parent() == Some(&*here) && read;
        inside || there == here || is_same_file(output, input)
    } else {
        // Nothing is there yet, but both would be written, as with --memory.
        there == here
    };
    // Not `/dev/stdin`.
    let is_named = input.is_file() && output.is_dir();
    replaced.then(|| if is_named { input } else { output }.to_owned())
}

/// Whether a file has a format that commands write and no recording has.
fn is_result(file: &Path) -> bool {
    let extension = file.extension().and_then(std::ffi::OsStr::to_str);
    extension.is_some_and(|it| ["html", "json", "jsonl", "md", "svg"].contains(&it))
}

/// The options of two outputs that name one file.
fn same<'a>(outputs: &'a [Named<'_>]) -> Option<[&'a str; 2]> {
    outputs.iter().enumerate().find_map(|(index, one)| {
        let mut others = outputs[..index].iter();
        let other = others.find(|other| place(one.path).is_some_and(|at| Some(at) == place(other.path)))?;
        Some([other.option.as_str(), one.option.as_str()])
    })
}

/// The absolute path without links; the last part need not exist. `None` for paths that cannot be resolved, as of
/// models with a name.
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
