// ${ proof.name }$_pcpi_formal: formal properties of ${ proof.name }$_pcpi
//
// For formal tools only. All inputs are arbitrary, also those from the processor, which may even
// abandon an instruction. A stub with the handshake of the core replaces the core: busy is high
// from the clock after start to done, and the results are arbitrary. To prove the properties, run
// in a directory with the files of both folders:
//   $ yosys -q ${ proof.name }$_pcpi_formal.ys
//   $ yosys-smtbmc -s z3 --unroll -t 3 ${ proof.name }$_pcpi_formal.smt2
//   $ yosys-smtbmc -s z3 --unroll -i -t 2 ${ proof.name }$_pcpi_formal.smt2
//
// Generated files belong to their user, without conditions.

`default_nettype none

<% include "core_stub.sv" %>

module ${ proof.name }$_pcpi_formal (
    input wire clk,
    input wire resetn,
    input wire pcpi_valid,
    input wire [31:0] pcpi_insn,
    input wire [31:0] pcpi_rs1,
    input wire [31:0] pcpi_rs2
);
    wire pcpi_wr;
    wire [31:0] pcpi_rd;
    wire pcpi_wait;
    wire pcpi_ready;

    ${ proof.name }$_pcpi dut (
        .clk(clk),
        .resetn(resetn),
        .pcpi_valid(pcpi_valid),
        .pcpi_insn(pcpi_insn),
        .pcpi_rs1(pcpi_rs1),
        .pcpi_rs2(pcpi_rs2),
        .pcpi_wr(pcpi_wr),
        .pcpi_rd(pcpi_rd),
        .pcpi_wait(pcpi_wait),
        .pcpi_ready(pcpi_ready)
    );

    // Internal signals of the design that the assertions read.
<%- for wire in proof.inside %>
    ${ wire }$
<%- endfor %>

    // The reset is active in the first clock. The state before it is arbitrary.
    always @* if ($initstate) assume (!resetn);

    wire [9:0] asked = {pcpi_insn[31:25], pcpi_insn[14:12]};
<% include "processor_answer.sv" %>

    wire [9:0] offered = asked;
    wire [31:0] word_0 = pcpi_rs1;
    wire [31:0] word_1 = pcpi_rs2;
    wire ours = pcpi_valid && pcpi_insn[6:0] == 7'b0001011 && known;
    always @* if (!$initstate) begin
        assert (dut.core.rst_n == resetn);
        assert (dut.computing == dut.core.run);
        // The processor waits for every instruction of the list, and for no other.
        assert (pcpi_wait == ours);
        assert (pcpi_wr == pcpi_ready);
        // An instruction starts a computation of its operands unless one is under way or has just
        // been answered. Nothing else starts one.
        assert (dut.start == (ours && !dut.core.run && !pcpi_ready));
        if (dut.start) begin
<%- for (operand, bits) in proof.operands %>
            assert (dut.core.${ operand }$ == ${ bits }$);
<%- endfor %>
        end
    end
    always @(posedge clk) if (!$initstate && $past(!$initstate) && $past(resetn)) begin
        // Each computation gives one answer, if its instruction still waits.
        assert (pcpi_ready == $past(dut.core.run && dut.core.ends && ours));
        if (pcpi_ready) assert (pcpi_rd == $past(answer));
    end
endmodule

`default_nettype wire
