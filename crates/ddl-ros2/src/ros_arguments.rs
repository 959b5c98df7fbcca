//! The arguments of ROS, as launch files give them: `--ros-args -r __node:=crowd -p topic:=/people --params-file FILE`.

use anyhow::{Context as _, bail};
use clap::{CommandFactory as _, Parser as _};
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fs;

use crate::options::{NAME, Options};
use crate::tell;

type Parameters = BTreeMap<String, Value>;

/// A file of parameters has one of these for each name of a node.
#[derive(Deserialize)]
struct OfNode {
    #[serde(default, rename = "ros__parameters")]
    parameters: Parameters,
}

/// The options of a command line, in which parameters of ROS are options by their names: `transform_age` is
/// `--transform-age`.
pub(crate) fn parse(line: impl Iterator<Item = OsString>) -> anyhow::Result<Options> {
    let (mut words, mut files, mut parameters) = (Vec::new(), Vec::new(), Parameters::new());
    let (mut space, mut name) = (None, None);
    let mut line = line;
    while let Some(word) = line.next() {
        if word != "--ros-args" {
            words.push(word);
            continue;
        }
        while let Some(word) = line.next().filter(|word| word != "--") {
            let mut value = || {
                let value = line.next().and_then(|value| value.into_string().ok());
                value.with_context(|| format!("after --ros-args, {} needs a value", word.display()))
            };
            match word.to_str() {
                Some("-p" | "--param") => {
                    let (name, value) = pair(&value()?)?;
                    let value = serde_saphyr::from_str(&value).unwrap_or(Value::String(value));
                    parameters.insert(name, value);
                }
                Some("-r" | "--remap") => {
                    let rule = value()?;
                    let (from, to) = pair(&rule)?;
                    let option = match from.as_str() {
                        "__node" | "__name" => format!("--name={}", name.insert(to)),
                        "__ns" => format!("--namespace={}", space.insert(to)),
                        _ => format!("--remap={rule}"),
                    };
                    words.push(option.into());
                }
                Some("--params-file") => files.push(value()?),
                Some("--log-level") => tell(&format!("note: --log-level {} has no effect", value()?)),
                _ => bail!(
                    "after --ros-args, {} is not known: give -p, -r or --params-file",
                    word.display()
                ),
            }
        }
    }
    let mut of_files = Parameters::new();
    for file in &files {
        of_files.extend(of_file(file, space.as_deref(), name.as_deref())?);
    }
    of_files.extend(parameters);
    for (name, value) in of_files {
        words.extend(option(&name, &value)?);
    }
    Ok(Options::parse_from(words))
}

fn pair(rule: &str) -> anyhow::Result<(String, String)> {
    let pair = rule
        .split_once(":=")
        .with_context(|| format!("{rule}: give NAME:=VALUE"))?;
    Ok((pair.0.to_owned(), pair.1.to_owned()))
}

/// The parameters of a file for this node.
fn of_file(file: &str, namespace: Option<&str>, name: Option<&str>) -> anyhow::Result<Parameters> {
    let text = fs::read_to_string(file).with_context(|| file.to_owned())?;
    let nodes: BTreeMap<String, OfNode> = serde_saphyr::from_str(&text).with_context(|| file.to_owned())?;
    let name = name.unwrap_or(NAME);
    let full = format!("{}/{name}", namespace.unwrap_or_default().trim_end_matches('/'));
    let mut parameters = Parameters::new();
    // `/**` first: a node's own parameters are above those of all.
    for (node, of_node) in nodes {
        if node == "/**" || node == full || node == name {
            parameters.extend(of_node.parameters);
        }
    }
    if parameters.is_empty() {
        tell(&format!("note: {file} has no parameters for {full} or /**"));
    }
    Ok(parameters)
}

/// A parameter as a word of the command line. Times are those of the messages: the clock of a simulation is not asked.
fn option(name: &str, value: &Value) -> anyhow::Result<Option<OsString>> {
    if name == "use_sim_time" {
        return Ok(None);
    }
    let option = name.replace('_', "-");
    let command = Options::command();
    let known = command.get_arguments().find(|known| known.get_long() == Some(&option));
    let known = known.with_context(|| format!("there is no parameter {name}: parameters are the options of --help"))?;
    let text = |value: &Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
    let text = match value {
        Value::Bool(is_set) if !known.get_action().takes_values() => {
            return Ok(is_set.then(|| format!("--{option}").into()));
        }
        Value::Array(values) => values.iter().map(text).collect::<Vec<_>>().join(","),
        value => text(value),
    };
    Ok(Some(format!("--{option}={text}").into()))
}
