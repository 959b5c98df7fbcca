//! Observations as files hold them.

use std::fmt::Write as _;

use ddl_data::{Format, Observation};

/// A file of some observations in each format.
pub(crate) fn written(rows: &[Observation], format: Format) -> String {
    let column = |value: &dyn Fn(&Observation) -> String| {
        rows.iter().map(value).collect::<Vec<_>>().join(",")
    };
    let mut text = String::new();
    match format {
        Format::StarCsv => {
            let lines = [
                column(&|o| o.frame.to_string()),
                column(&|o| o.pedestrian.to_string()),
                column(&|o| o.position[1].to_string()),
                column(&|o| o.position[0].to_string()),
            ];
            text = lines.join("\n");
        }
        Format::SocialGan => {
            for o in rows {
                let [x, y] = o.position;
                writeln!(text, "{}\t{}.0\t{x}\t{y}", o.frame, o.pedestrian).unwrap();
            }
        }
        Format::TrajNet => {
            for (scene, o) in rows.iter().enumerate() {
                let [x, y] = o.position;
                let (f, p) = (o.frame, o.pedestrian);
                writeln!(text, "{{\"scene\":{{\"id\":{scene},\"p\":{p},\"s\":{f},\"e\":{f},\"fps\":2.5,\"tag\":[4,[]]}}}}").unwrap();
                writeln!(
                    text,
                    "{{\"track\":{{\"f\":{f},\"p\":{p},\"x\":{x:?},\"y\":{y:?}}}}}"
                )
                .unwrap();
                // a forecast of the same moment is no observation
                writeln!(text, "{{\"track\":{{\"f\":{f},\"p\":{p},\"x\":0.5,\"y\":{x:?},\"prediction_number\":0,\"scene_id\":{scene}}}}}").unwrap();
            }
        }
        Format::Obsmat => {
            for o in rows {
                let [x, y] = o.position;
                writeln!(
                    text,
                    "  {:e}   {:e}  {x:e}  0.0e+00 {y:e} 1.5e+0 0 -2E-3",
                    o.frame as f64, o.pedestrian.0 as f64
                )
                .unwrap();
            }
        }
        _ => {
            text.push_str("pedestrian,frame,y,x\n");
            for o in rows {
                let [x, y] = o.position;
                writeln!(text, "{},{},{y},{x}", o.pedestrian, o.frame).unwrap();
            }
        }
    }
    text
}
