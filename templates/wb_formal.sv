// ${ name }$_wb_formal: formal properties of ${ name }$_wb
//
// For formal tools only. All inputs are arbitrary, also those from the master, which may even
// abandon a request. A stub that answers requests at arbitrary times replaces the registers. To
// prove the properties, run in a directory with the files of both folders:
//   $ yosys -q ${ name }$_wb_formal.ys
//   $ yosys-smtbmc -s z3 --unroll -t 3 ${ name }$_wb_formal.smt2
//   $ yosys-smtbmc -s z3 --unroll -i -t 2 ${ name }$_wb_formal.smt2
//
// Generated files belong to their user, without conditions.

`default_nettype none

<% include "registers_stub.sv" %>

module ${ name }$_wb_formal (
    input wire wb_clk_i,
    input wire wb_rst_i,
    input wire wb_cyc_i,
    input wire wb_stb_i,
    input wire wb_we_i,
    input wire [${ address_high }$:0] wb_adr_i,
    input wire [31:0] wb_dat_i,
    input wire [3:0] wb_sel_i
);
    wire [31:0] wb_dat_o;
    wire wb_ack_o;
    wire wb_err_o;
    wire irq;

    ${ name }$_wb dut (
        .wb_clk_i(wb_clk_i),
        .wb_rst_i(wb_rst_i),
        .wb_cyc_i(wb_cyc_i),
        .wb_stb_i(wb_stb_i),
        .wb_we_i(wb_we_i),
        .wb_adr_i(wb_adr_i),
        .wb_dat_i(wb_dat_i),
        .wb_sel_i(wb_sel_i),
        .wb_dat_o(wb_dat_o),
        .wb_ack_o(wb_ack_o),
        .wb_err_o(wb_err_o),
        .irq(irq)
    );

    // Internal signals of the design that the assertions read.
    (* hierconn *) wire \dut.write ;
    (* hierconn *) wire \dut.read ;
    (* hierconn *) wire \dut.write_answer ;
    (* hierconn *) wire \dut.write_error ;
    (* hierconn *) wire \dut.read_answer ;
    (* hierconn *) wire \dut.read_error ;
    (* hierconn *) wire [31:0] \dut.registers.read_data ;
<% include "registers_inside.sv" %>

    // The reset is active in the first clock. The state before it is arbitrary.
    always @* if ($initstate) assume (wb_rst_i);

    wire answered = wb_ack_o || wb_err_o;
    always @* if (!$initstate) begin
        // At most one of ack and err is high. A request goes to the registers until it is answered.
        assert (!(wb_ack_o && wb_err_o));
        assert (dut.write == (wb_cyc_i && wb_stb_i && wb_we_i && !answered));
        assert (dut.read == (wb_cyc_i && wb_stb_i && !wb_we_i && !answered));
        // The registers get the address, data and byte enables of the request.
        assert (\dut.registers.rst_n == !wb_rst_i && irq == \dut.registers.irq );
        if (dut.write) begin
            assert (\dut.registers.write_at == wb_adr_i[${ address_high }$:2]);
            assert (\dut.registers.write_data == wb_dat_i);
            assert (\dut.registers.write_bytes == wb_sel_i);
        end
        if (dut.read) assert (\dut.registers.read_at == wb_adr_i[${ address_high }$:2]);
        // The data come from the registers, which show them in the clock after their answer.
        assert (wb_dat_o == \dut.registers.read_data );
    end
    always @(posedge wb_clk_i) if (!$initstate && $past(!$initstate)) begin
        // Each request gets one answer, in the clock after the registers answered. Without a
        // request there is no answer.
        assert (wb_ack_o == $past(!wb_rst_i && (dut.write_answer && !dut.write_error
                || dut.read_answer && !dut.read_error)));
        assert (wb_err_o == $past(!wb_rst_i && (dut.write_answer && dut.write_error
                || dut.read_answer && dut.read_error)));
        if (answered) assert ($past(wb_cyc_i && wb_stb_i));
        if ($past(answered)) assert (!answered);
    end
endmodule

`default_nettype wire
