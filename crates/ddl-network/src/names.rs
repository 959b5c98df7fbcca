//! Names of enum values on the command line, in files and in reports.

/// Implements `name`, `Display` and `FromStr` for an enum. The error of `FromStr` names the configuration field
/// `$field`.
macro_rules! named {
    ($type:ident, $field:literal, $first:ident => $first_name:literal $(, $value:ident => $name:literal)*) => {
        impl $type {
            /// The name used on the command line and in reports.
            pub fn name(self) -> &'static str {
                match self {
                    Self::$first => $first_name,
                    $(Self::$value => $name,)*
                }
            }
        }

        impl std::fmt::Display for $type {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str(self.name())
            }
        }

        impl std::str::FromStr for $type {
            type Err = crate::NetworkError;

            fn from_str(text: &str) -> Result<Self, Self::Err> {
                match text {
                    $first_name => Ok(Self::$first),
                    $($name => Ok(Self::$value),)*
                    _ => Err(crate::NetworkError::Config {
                        field: $field,
                        value: text.to_owned(),
                        rule: concat!("one of ", $first_name $(, ", ", $name)*),
                    }),
                }
            }
        }
    };
}
pub(crate) use named;

#[cfg(test)]
mod tests {
    use crate::{DeviceChoice, Variant};

    #[test]
    fn names_are_parsed_and_unknown_names_refused_with_the_list() {
        for variant in Variant::ALL {
            assert_eq!(variant.to_string().parse::<Variant>().unwrap(), variant);
        }
        let error = "gpu".parse::<DeviceChoice>().unwrap_err().to_string();
        let expected = "configuration: device = gpu is not allowed: one of auto, cpu, cuda";
        assert_eq!(error, expected);
    }
}
