//! Published numbers of others, as printed by their sources.

use crate::document::Part;
use crate::literature::{LITERATURE, measured_table, published_table, social_gan_joint_table};
use ddl_data::Convention;
use ddl_eval::ResultRow;

pub(super) fn parts(rows: &[ResultRow]) -> Vec<Part> {
    let star = rows.iter().any(|row| row.conditions.convention == Convention::Star);
    let other = if star || rows.is_empty() {
        ""
    } else {
        " No result above is in the `star` convention, so STAR, DDL and the reference values below are not comparable \
         with them."
    };
    vec![
        Part::heading("Published numbers"),
        Part::Paragraph(format!(
            "As printed by their sources, ADE/FDE in metres, best of 20. None of them was measured here.{other}"
        )),
        Part::subheading("Table I of the DDL paper"),
        Part::Paragraph(
            "This table mixes data conventions: most rows above DDL were measured by their authors in the \
             `social-gan` convention, whose ETH is harder; STAR and DDL are in `star`. Compare DDL and STAR with \
             `published` results in the `star` convention alone."
                .to_owned(),
        ),
        Part::Table(published_table(&LITERATURE.table_one, 2)),
        Part::subheading("Best published systems in the `star` convention (minADE20/minFDE20)"),
        Part::Table(published_table(&LITERATURE.star_convention, 2)),
        Part::subheading("Best published systems in the `social-gan` convention (minADE20/minFDE20)"),
        Part::Table(published_table(&LITERATURE.social_gan_convention, 2)),
        Part::subheading("One forecast in the `social-gan` convention (ADE/FDE)"),
        Part::Paragraph(
            "Windows of at least one pedestrian: compare with window rule `social-gan` (at least 1 pedestrians) under \
             `single`, and leave univ out, whose windows are others."
                .to_owned(),
        ),
        Part::Table(published_table(&LITERATURE.social_gan_single, 3)),
        Part::subheading("Joint errors on eth in the `social-gan` convention"),
        Part::Paragraph(
            "Means over windows of at least one pedestrian: compare with JADE and JFDE by window under `joint`, window \
             rule `social-gan` (at least 1 pedestrians)."
                .to_owned(),
        ),
        Part::Table(social_gan_joint_table()),
        Part::heading("Reference values of baselines"),
        Part::Paragraph(
            "Measured once on all test windows of the `star` convention, window rule `published`; ADE/FDE in metres."
                .to_owned(),
        ),
        Part::Table(measured_table()),
    ]
}
