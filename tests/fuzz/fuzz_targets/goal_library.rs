#![no_main]
ddl_fuzz::target!(goal_library::read);
