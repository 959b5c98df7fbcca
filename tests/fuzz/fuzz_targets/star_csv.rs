#![no_main]
ddl_fuzz::target!(tracks::star_csv);
