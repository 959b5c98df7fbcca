#![no_main]
ddl_fuzz::target!(tracks::social_gan);
