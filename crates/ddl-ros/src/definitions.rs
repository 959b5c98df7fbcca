//! The text of definitions, as recordings (rosbag2, MCAP) store it.

/// The messages of others: fields, types and constants in their order, without their comments.
const STANDARD: &str = include_str!("../msg/standard.txt");
const STANDARD_SEPARATOR: &str = "\n===\n";

const OWN: [(&str, &str); 3] = [
    ("ddl_msgs/Forecasts", include_str!("../msg/Forecasts.msg")),
    ("ddl_msgs/PedestrianForecast", include_str!("../msg/PedestrianForecast.msg")),
    ("ddl_msgs/Hypothesis", include_str!("../msg/Hypothesis.msg")),
];

/// The definition of a message, such as `nav_msgs/msg/Path`, followed by those of all messages in it; `None` for a type
/// that this crate does not have.
pub fn definition(type_name: &str) -> Option<String> {
    let short = type_name.replacen("/msg/", "/", 1);
    let mut names = vec![short.as_str()];
    let mut text = String::new();
    let mut next = 0;
    while let Some(&name) = names.get(next) {
        let body = body(name)?;
        if next > 0 {
            text = text + &"=".repeat(80) + "\nMSG: " + name + "\n";
        }
        text = text + body.trim_end() + "\n";
        for part in body.lines().filter_map(message_in) {
            if !names.contains(&part) {
                names.push(part);
            }
        }
        next += 1;
    }
    Some(text)
}

/// The name of the message that a line has a field of.
fn message_in(line: &str) -> Option<&str> {
    let kind = line.split_whitespace().next()?;
    let kind = kind.split_once('[').map_or(kind, |(kind, _)| kind);
    (kind.contains('/') && !kind.starts_with('#')).then_some(kind)
}

fn body(short: &str) -> Option<&'static str> {
    if let Some((_, body)) = OWN.iter().find(|(name, _)| *name == short) {
        return Some(body);
    }
    let mut messages = STANDARD.split(STANDARD_SEPARATOR);
    messages.find_map(|message| {
        let (head, body) = message.split_once('\n')?;
        (head.strip_prefix("MSG: ")? == short).then_some(body)
    })
}
