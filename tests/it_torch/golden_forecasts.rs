//! The file of golden forecasts, against libtorch. With `DDL_WRITE_GOLDEN=1` the test writes the file, which is needed
//! after the built-in models were trained again.

use ddl::{BuiltinModel, Ddl, ModelSource};
use ddl_tests::golden::{self, Golden};

#[test]
fn golden_forecasts_agree_with_libtorch() {
    let reference = |model: BuiltinModel| Golden::of(&Ddl::reference(&ModelSource::Builtin(model)).unwrap());
    if std::env::var_os("DDL_WRITE_GOLDEN").is_some() {
        let models = BuiltinModel::ALL.map(|model| {
            let rows = reference(model).into_iter();
            let rows: Vec<String> = rows.map(|row| serde_json::to_string(&row).unwrap()).collect();
            format!("\"{model}\": [\n{}\n]", rows.join(",\n"))
        });
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/golden/forecasts.json");
        std::fs::write(file, format!("{{\n{}\n}}\n", models.join(",\n"))).unwrap();
        return;
    }
    golden::check(reference);
}
