    (* hierconn *) wire \dut.registers.rst_n ;
    (* hierconn *) wire \dut.registers.irq ;
    (* hierconn *) wire [${ address_high }$:2] \dut.registers.write_at ;
    (* hierconn *) wire [31:0] \dut.registers.write_data ;
    (* hierconn *) wire [3:0] \dut.registers.write_bytes ;
    (* hierconn *) wire [${ address_high }$:2] \dut.registers.read_at ;
