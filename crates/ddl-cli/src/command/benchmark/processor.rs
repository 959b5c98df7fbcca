//! The name of this machine's processor, printed beside measured times.

use std::fs;

/// The name that Linux gives it, or else the architecture.
pub(super) fn name() -> String {
    let told = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    model_name(&told).unwrap_or_else(|| std::env::consts::ARCH.to_owned())
}

fn model_name(cpuinfo: &str) -> Option<String> {
    let values = cpuinfo.lines().filter_map(|line| line.split_once(':'));
    let mut names = values.filter(|(field, _)| field.trim() == "model name");
    let (_, name) = names.next()?;
    Some(name.trim().replace("(R)", "").replace("(TM)", ""))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_model_is_found_where_linux_names_it() {
        let intel = "processor\t: 0\nmodel\t\t: 143\nmodel name\t: Intel(R) Xeon(R) Gold 6430\n";
        assert_eq!(model_name(intel).as_deref(), Some("Intel Xeon Gold 6430"));
        assert_eq!(model_name("processor\t: 0\nBogoMIPS\t: 50.00\n"), None);
        assert!(!name().is_empty());
    }
}
