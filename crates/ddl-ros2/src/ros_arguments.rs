//! The arguments of ROS, as launch files give them: `--ros-args -r __node:=crowd -p topic:=/people --params-file FILE`.

use crate::options::{NodeArguments, pair};
use crate::tell;
use anyhow::{Context as _, bail, ensure};
use clap::builder::ValueParser;
use clap::{CommandFactory as _, Parser as _};
use serde_json::{Map, Value};
use std::ffi::OsString;
use std::fs;

type Parameters = Map<String, Value>;

/// Parameters of ROS itself. Times are those of the messages: the clock of a simulation is not asked.
const OF_ROS: [&str; 3] = ["use_sim_time", "qos_overrides", "start_type_description_service"];
/// Where the parameters of a node are in a file.
const SECTION: &str = "ros__parameters";

/// The options of a command line, in which parameters of ROS are options by their names: `transform_age` is
/// `--transform-age`.
pub(crate) fn parse(mut line: impl Iterator<Item = OsString>) -> anyhow::Result<NodeArguments> {
    let (mut words, mut files, mut parameters) = (Vec::new(), Vec::new(), Parameters::new());
    while let Some(word) = line.next() {
        if word != "--ros-args" {
            words.push(word);
            continue;
        }
        while let Some(word) = line.next().filter(|word| word != "--") {
            let word = word.to_string_lossy().into_owned();
            let mut value = || {
                let value = line.next().and_then(|value| value.into_string().ok());
                value.with_context(|| format!("after --ros-args, {word} needs a value"))
            };
            match word.as_str() {
                "-p" | "--param" => {
                    let (name, value) = pair(&value()?)?;
                    let is_list = value.starts_with('[');
                    let list = is_list.then(|| serde_saphyr::from_str(&value).context(name.clone()));
                    parameters.insert(name, list.transpose()?.unwrap_or(Value::String(value)));
                }
                "-r" | "--remap" => words.push(renamed(&value()?)?.into()),
                "--params-file" => files.push(value()?),
                "--log-level" | "--log-config-file" | "-e" | "--enclave" => {
                    tell(&format!("note: {word} {} has no effect", value()?));
                }
                _ if word.starts_with("--enable-") || word.starts_with("--disable-") => {
                    tell(&format!("note: {word} has no effect"));
                }
                _ => bail!("after --ros-args, {word} is not known: give -p, -r or --params-file"),
            }
        }
    }
    // The files need the name of the node, which only the line gives.
    let named = NodeArguments::command().ignore_errors(true).try_get_matches_from(&words);
    let of = |id| named.as_ref().ok()?.get_one::<String>(id).map(String::as_str);
    let node = format!("{}/{}", of("namespace").unwrap_or_default(), of("name").unwrap_or_default());
    let mut of_files = Parameters::new();
    for file in &files {
        of_files.extend(of_file(file, &node)?);
    }
    of_files.extend(parameters);
    for (name, value) in of_files {
        words.extend(option(&name, &value)?);
    }
    Ok(NodeArguments::parse_from(words))
}

/// The option of a rule that gives a topic or the node another name.
fn renamed(rule: &str) -> anyhow::Result<String> {
    let (from, to) = pair(rule)?;
    ensure!(!from.contains(':'), "{rule}: leave out what is before the name; there is one node");
    Ok(match from.as_str() {
        "__node" | "__name" => format!("--name={to}"),
        "__ns" => format!("--namespace={to}"),
        _ => format!("--remap={rule}"),
    })
}

/// The parameters of a file for this node; those of sections further down count.
fn of_file(file: &str, node: &str) -> anyhow::Result<Parameters> {
    let text = fs::read_to_string(file).with_context(|| file.to_owned())?;
    let sections: Value = serde_saphyr::from_str(&text).with_context(|| file.to_owned())?;
    let mut parameters = Parameters::new();
    collect(&sections, "", &tokens(node), &mut parameters);
    if parameters.is_empty() {
        tell(&format!("note: {file} has no parameters for {node}"));
    }
    Ok(parameters)
}

fn tokens(name: &str) -> Vec<&str> {
    name.split('/').filter(|token| !token.is_empty()).collect()
}

fn collect(section: &Value, name: &str, node: &[&str], parameters: &mut Parameters) {
    for (key, value) in section.as_object().into_iter().flatten() {
        if key != SECTION {
            collect(value, &format!("{name}/{key}"), node, parameters);
        } else if is_named(&tokens(name), node) {
            parameters.extend(value.as_object().cloned().unwrap_or_default());
        }
    }
}

/// Whether a node has this name, in which `*` stands for one token, and `**` for any number.
fn is_named(name: &[&str], node: &[&str]) -> bool {
    match (name, node) {
        (["**", rest @ ..], _) => (0..=node.len()).any(|skipped| is_named(rest, &node[skipped..])),
        ([first, rest @ ..], [token, tokens @ ..]) => (*first == "*" || first == token) && is_named(rest, tokens),
        _ => name.is_empty() && node.is_empty(),
    }
}

/// A parameter as a word of the command line; none for one that is not set.
fn option(name: &str, value: &Value) -> anyhow::Result<Option<OsString>> {
    if OF_ROS.iter().any(|other| name.split('.').next() == Some(other)) {
        return Ok(None);
    }
    let option = name.replace('_', "-");
    let command = NodeArguments::command();
    let known = command.get_arguments().find(|known| known.get_long() == Some(&option));
    let known = known.filter(|_| !["name", "namespace", "remap"].contains(&name));
    let known = known.with_context(|| {
        format!("there is no parameter {name}: parameters are the options of --help, without names (-r __node:=NAME)")
    })?;
    let text = |value: &Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
    let is_text = known.get_value_parser().type_id() == ValueParser::string().type_id();
    let word = match value {
        Value::Array(values) if values.is_empty() => return Ok(None),
        Value::Array(values) => values.iter().map(text).collect::<Vec<_>>().join(","),
        Value::Null | Value::Object(_) => bail!("parameter {name} has no value: give one, or leave it out"),
        Value::Number(_) | Value::Bool(_) if is_text => bail!("parameter {name} is a text: write {value} in quotes"),
        value => text(value),
    };
    if known.get_action().takes_values() {
        return Ok(Some(format!("--{option}={word}").into()));
    }
    let is_set: bool = word.parse().with_context(|| format!("parameter {name} is true or false, not {word}"))?;
    Ok(is_set.then(|| format!("--{option}").into()))
}
