# Stand-ins for the commands of Vivado, Quartus and Platform Designer that emitted scripts call.
#
#   tclsh stubs.tcl SCRIPT ?ARGUMENT ...?
#
# Each prints its call. It refuses options that the vendor's manual (UG835; Quartus Tcl reference; Platform Designer's
# component interface) does not have, and sources that are not there. What is no command of the list is
# none at all, as in the vendor's tool.

# A command, its options, and what it returns.
proc command {name options {result ""}} {
    set body [string map [list @NAME@ $name @OPTIONS@ "{$options}" @RESULT@ [list $result]] {
        foreach word $args {
            if {[string match {-[a-z]*} $word] && $word ni @OPTIONS@} {
                error "@NAME@ has no option $word"
            }
            if {[regexp {^/.*\.(v|mem|xdc|sdc)$} $word] && ![file exists $word]} {
                error "@NAME@: there is no $word"
            }
        }
        puts [string trim "@NAME@ $args"]
        return @RESULT@
    }]
    namespace eval [namespace qualifiers ::$name] {}
    proc ::$name args $body
}

# Vivado.
command read_verilog {-sv}
command read_mem {}
command read_xdc {-mode -unmanaged -cells -ref}
command synth_design {-top -part -mode -generic}
command opt_design {}
command place_design {}
command phys_opt_design {}
command route_design {}
command write_checkpoint {-force}
command report_utilization {-file}
command report_timing_summary {-file}
command get_timing_paths {-delay_type -max_paths} path0
command get_property {} $env(SLACK)
command create_project {-part -force -in_memory}
command add_files {-norecurse -fileset}
command current_fileset {} sources_1
command set_property {}
command update_compile_order {-fileset}
command close_project {}
command ipx::package_project {-root_dir -vendor -library -taxonomy -import_files -force}
command ipx::current_core {} core0
command ipx::get_bus_interfaces {-of_objects} {}
command ipx::infer_bus_interface {} interface0
command ipx::add_bus_parameter {} parameter0
command ipx::associate_bus_interfaces {-busif -clock -reset}
command ipx::create_xgui_files {}
command ipx::update_checksums {}
command ipx::check_integrity {}
command ipx::save_core {}

# Quartus.
package provide ::quartus::project 1.0
package provide ::quartus::flow 1.0
command project_new {-overwrite -revision -family -part}
command project_close {}
command set_global_assignment {-name}
command set_instance_assignment {-name -to}
command export_assignments {}
command execute_flow {-compile}

# Platform Designer.
package provide qsys 16.1
command set_module_property {}
command add_fileset {}
command set_fileset_property {}
command add_fileset_file {}
command add_interface {}
command set_interface_property {}
command add_interface_port {}

set script [lindex $argv 0]
set argv [lrange $argv 1 end]
set argc [llength $argv]
info script $script
source $script
