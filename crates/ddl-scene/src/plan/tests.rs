use super::*;

fn plan(rows: &[[f64; 4]]) -> Result<Plan, PlanError> {
    Plan::new(rows.iter().map(|&[time, x, y, radius]| PlanPoint { time, position: [x, y], radius }).collect())
}

#[test]
fn between_rows_the_way_is_a_line_and_the_radius_holds() {
    let plan = plan(&[[1.0, 2.0, -3.0, 0.2], [3.0, 6.0, 5.0, 1.0], [4.0, 6.0, 5.5, 0.0]]).unwrap();
    for (time, [x, y, radius]) in [
        (-5.0, [2.0, -3.0, 0.2]),
        (1.0, [2.0, -3.0, 0.2]),
        (1.5, [3.0, -1.0, 0.2]),
        (3.0, [6.0, 5.0, 1.0]),
        (3.6, [6.0, 5.3, 1.0]),
        (4.0, [6.0, 5.5, 0.0]),
        (60.0, [6.0, 5.5, 0.0]),
    ] {
        let found = plan.at(time);
        let off = [found.time - time, found.position[0] - x, found.position[1] - y, found.radius - radius];
        assert!(off.iter().all(|off| off.abs() < 1e-12), "{found:?}");
    }
}

#[test]
fn rows_that_make_no_plan_are_refused() {
    let good = [0.0, 1.0, 2.0, 0.3];
    let edges = [[-9.0, 1e7, -1e7, 0.0], [0.0, 1.0, 1.0, 0.0]];
    assert!(plan(&edges).is_ok() && plan(&edges[..1]).is_err() && plan(&[]).is_err());
    assert!(plan(&[[4.8, 1.0, 1.0, 0.0]]).is_ok() && plan(&[[4.9, 1.0, 1.0, 0.0]]).is_err());
    assert!(plan(&[good, good]).is_err() && plan(&[[1.0, 1.0, 2.0, 0.3], good]).is_err());
    let wrong = [[0.0, f64::NAN], [1.0, f64::INFINITY], [1.0, 1.1e7], [2.0, -1.1e7], [3.0, 1.1e7], [3.0, -0.1]];
    for (column, value) in wrong.map(|[column, value]| (column as usize, value)) {
        let mut wrong = [1.0, 1.0, 2.0, 0.3];
        wrong[column] = value;
        let refused = plan(&[good, wrong]).unwrap_err();
        let start = format!("row 2 of the plan: {} is {value}", ["time", "x", "y", "radius"][column]);
        assert!(refused.to_string().starts_with(&start), "{refused}");
    }
}
