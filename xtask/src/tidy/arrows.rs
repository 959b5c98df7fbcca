//! Which crate of the workspace may depend on which: the arrows of the house, and no others.

use serde_json::Value;

use super::Findings;

/// Crate, and the workspace crates it may depend on in any way (also for its tests).
const ARROWS: [(&str, &[&str]); 13] = [
    ("ddl-data", &[]),
    ("ddl-simd", &[]),
    ("ddl-softdtw", &["ddl-simd"]),
    ("ddl-dynamics", &[]),
    ("ddl-goal", &["ddl-softdtw"]),
    ("ddl-network", &["ddl-data", "ddl-dynamics", "ddl-simd"]),
    ("ddl-star", &["ddl-data", "ddl-dynamics", "ddl-network"]),
    ("ddl-eval", &["ddl-data"]),
    ("ddl-report", &["ddl-data", "ddl-eval"]),
    (
        "ddl",
        &[
            "ddl-data",
            "ddl-softdtw",
            "ddl-dynamics",
            "ddl-goal",
            "ddl-network",
            "ddl-star",
            "ddl-eval",
            "ddl-report",
        ],
    ),
    ("ddl-cli", &["ddl"]),
    ("xtask", &["ddl-data"]),
    (
        "ddl-tests",
        &[
            "ddl-data",
            "ddl-softdtw",
            "ddl-dynamics",
            "ddl-goal",
            "ddl-network",
            "ddl-star",
            "ddl-eval",
            "ddl-report",
            "ddl",
            "ddl-cli",
        ],
    ),
];

/// The binding of libtorch, and the one crate that may touch it.
const BINDING: [&str; 2] = ["tch", "torch-sys"];
const BINDING_OWNER: &str = "ddl-star";

pub(super) fn check(metadata: &Value, findings: &mut Findings) {
    let packages: Vec<&Value> = metadata["packages"]
        .as_array()
        .into_iter()
        .flatten()
        .collect();
    let members: Vec<&str> = packages
        .iter()
        .filter_map(|package| package["name"].as_str())
        .collect();
    for package in &packages {
        let Some(name) = package["name"].as_str() else {
            continue;
        };
        let allowed = ARROWS
            .iter()
            .find(|(from, _)| *from == name)
            .map(|(_, to)| *to);
        if allowed.is_none() {
            findings.fault(format!(
                "{name} is not in the table of crates: add it to xtask/src/tidy/arrows.rs and \
                 docs/architecture.md, with what it may depend on"
            ));
        }
        for dependency in package["dependencies"].as_array().into_iter().flatten() {
            let Some(to) = dependency["name"].as_str() else {
                continue;
            };
            if members.contains(&to) && !allowed.unwrap_or_default().contains(&to) {
                findings.fault(format!("{name} must not depend on {to}"));
            }
            if BINDING.contains(&to) && name != BINDING_OWNER {
                findings.fault(format!(
                    "{name} depends on {to}: only {BINDING_OWNER} may touch libtorch"
                ));
            }
        }
    }
    for (name, _) in ARROWS.iter().filter(|(name, _)| !members.contains(name)) {
        findings.fault(format!("the crate {name} is missing from the workspace"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn faults(extra: &[(&str, &str)]) -> Vec<String> {
        let packages: Vec<Value> = ARROWS
            .iter()
            .map(|(name, allowed)| {
                let wrong = extra
                    .iter()
                    .filter(|(from, _)| from == name)
                    .map(|(_, to)| to);
                let dependencies: Vec<Value> = allowed
                    .iter()
                    .chain(wrong)
                    .map(|to| json!({ "name": to }))
                    .collect();
                json!({ "name": name, "dependencies": dependencies })
            })
            .collect();
        let mut findings = Findings::default();
        check(&json!({ "packages": packages }), &mut findings);
        findings.faults
    }

    #[test]
    fn the_table_itself_is_allowed_and_has_no_circle() {
        assert_eq!(faults(&[]), [] as [&str; 0]);
        // Every crate stands after those it may depend on, so no circle can close (the tests and
        // xtask are depended on by nobody).
        let place = |name: &str| ARROWS.iter().position(|(from, _)| *from == name).unwrap();
        for (from, allowed) in &ARROWS {
            assert!(allowed.iter().all(|to| place(to) < place(from)), "{from}");
        }
    }

    #[test]
    fn a_wrong_arrow_is_named() {
        assert_eq!(
            faults(&[("ddl-data", "ddl-eval")]),
            ["ddl-data must not depend on ddl-eval"]
        );
        assert_eq!(
            faults(&[("xtask", "ddl-eval")]),
            ["xtask must not depend on ddl-eval"]
        );
        let binding = faults(&[("ddl-eval", "tch")]);
        assert_eq!(
            binding,
            ["ddl-eval depends on tch: only ddl-star may touch libtorch"]
        );
        assert_eq!(
            faults(&[("ddl-star", "tch"), ("ddl-goal", "serde")]),
            [] as [&str; 0]
        );
    }

    #[test]
    fn unknown_and_missing_crates_are_named() {
        let mut findings = Findings::default();
        check(
            &json!({ "packages": [{ "name": "ddl-new", "dependencies": [] }] }),
            &mut findings,
        );
        assert!(findings.faults[0].contains("ddl-new is not in the table"));
        assert_eq!(findings.faults.len(), 1 + ARROWS.len());
    }
}
