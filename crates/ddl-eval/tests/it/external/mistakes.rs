//! Every error names its place.

use ddl_eval::external::{self, Coverage, ExternalFormat};

use super::files::{HEADER, complaint, hypothesis, line, rows, whole_file, windows};

const CASES: &str = include_str!("mistakes.txt");

fn check(format: ExternalFormat, text: &str, expected: &str) {
    let complaint = complaint(text, format);
    let expected = format!("f, line {expected}");
    assert!(complaint.starts_with(&expected), "{text}\n{complaint}\n{expected}");
}

/// The cases of a section of `mistakes.txt`.
pub(super) fn cases_of(section: &str) -> Vec<String> {
    let (_, cases) = CASES.split_once(&format!("== {section}\n")).unwrap();
    cases.split("\n== ").next().unwrap().trim().replace("\\\n", "").lines().map(str::to_owned).collect()
}

/// The cases of a section; `file` makes the file of the parts of a case.
fn check_all(format: ExternalFormat, section: &str, file: impl Fn(&[&str]) -> String) {
    for case in cases_of(section) {
        let parts: Vec<&str> = case.split(" =>").map(str::trim).collect();
        let (expected, parts) = parts.split_last().unwrap();
        check(format, &file(parts), expected);
    }
}

fn edited(good: &str, from: &str, to: &str) -> String {
    assert!(good.contains(from), "{from}");
    good.replacen(from, &to.replace("\\n", "\n"), 1)
}

#[test]
fn every_mistake_of_json_lines_is_named_with_its_place() {
    let format = ExternalFormat::JsonLines;
    let first = line(70, 3, &hypothesis(1.0));
    check(format, "", "1: the file holds no forecast");
    check(format, &"[".repeat(100_000), "1: not a JSON object");
    check_all(format, "second lines of JSON", |parts| first.clone() + parts[0]);
    let both = first.clone() + &line(70, 5, &hypothesis(2.0));
    check_all(format, "edits of JSON", |parts| {
        // The common start of both lines is replaced in the second, unless it is only a brace.
        let start = if parts[0] == "{" { 0 } else { first.len() };
        both[..start].to_owned() + &edited(&both[start..], parts[0], parts[1])
    });
}

#[test]
fn every_mistake_of_several_hypotheses_is_named_with_its_place() {
    let format = ExternalFormat::JsonLines;
    let first = line(70, 3, &hypothesis(1.0));
    let twice = hypothesis(1.0) + "," + &hypothesis(2.0);
    check(format, &(first + &line(70, 5, &twice)), "2: 2 hypotheses, but 1 on line 1");
    // Fields of two hypotheses. Some programs write a list of nulls for a goal of NaN, which is an error; a plain null
    // means no goal.
    check_all(format, "pairs of fields of JSON", |parts| {
        let with = |field: &&str| hypothesis(1.0).replacen('{', &format!("{{{field}"), 1);
        let both: Vec<String> = parts.iter().map(with).collect();
        line(70, 5, &both.join(","))
    });
    let many = line(70, 5, &vec![hypothesis(1.0); 21].join(","));
    let expected = "1, hypotheses: more than 20 hypotheses of observed until 70 pedestrian 5; the protocols allow 20";
    check(format, &many, expected);
}

#[test]
fn every_mistake_of_a_table_is_named_with_its_place() {
    let format = ExternalFormat::Table;
    let first = HEADER.to_owned() + &rows("yard", 70, 3, 0, 1.0, 1.0);
    let second = rows("yard", 70, 5, 0, 1.0, 2.0);
    for (text, expected) in [
        ("", "1: the file holds no forecast"),
        (HEADER, "1: the file holds no forecast"),
        ("observed_until,pedestrian,x,y\n", "1: the header must name"),
        (&HEADER.replace("certified", "x"), "1: the header must name"),
        (&(HEADER.to_owned() + "\""), "2: a quote is not closed on this line"),
    ] {
        check(format, text, expected);
    }
    check_all(format, "edits of a table", |parts| first.clone() + &edited(&second, parts[0], parts[1]));
    // Pedestrian, hypothesis and weight of each row.
    let text_of = |sequence: &str| {
        let part = |part: &str| {
            let numbers: Vec<f64> = part.split('/').map(|n| n.parse().unwrap()).collect();
            rows("yard", 70, numbers[0] as i64, numbers[1] as i64, numbers[2], 1.0)
        };
        HEADER.to_owned() + &sequence.split(' ').map(part).collect::<String>()
    };
    check_all(format, "sequences of a table", |parts| text_of(parts[0]));
    let many: Vec<String> = (0..1000).map(|k| format!("5/{k}/0.001")).collect();
    let expected = "242, hypothesis: more than 20 hypotheses of `yard` observed until 70 pedestrian 5";
    check(format, &text_of(&many.join(" ")), expected);
}

#[test]
fn text_that_is_not_utf8_is_refused_at_its_line() {
    let mut bytes = whole_file().into_bytes();
    bytes.extend(b"\xff\xfe\n");
    let other: &[u8] = b"\n\xff";
    for (format, text, line) in [(ExternalFormat::JsonLines, &bytes[..], 4), (ExternalFormat::Table, other, 2)] {
        let error = external::read_from(text, "f", format, &windows(), Coverage::Whole);
        let expected = format!("f, line {line}: the text is not UTF-8; export the file as plain UTF-8 or ASCII text");
        assert_eq!(error.unwrap_err().to_string(), expected);
    }
}
