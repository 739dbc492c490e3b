// ${ proof.name }$_cfu_formal: formal properties of ${ proof.name }$_cfu
//
// For formal tools only. All inputs are arbitrary. A stub with the handshake of the core replaces
// the core: busy is high from the clock after start to done, and the results are arbitrary. To
// prove the properties, run in a directory with the files of both folders:
//   $ yosys -q ${ proof.name }$_cfu_formal.ys
//   $ yosys-smtbmc -s z3 --unroll -t 3 ${ proof.name }$_cfu_formal.smt2
//   $ yosys-smtbmc -s z3 --unroll -i -t 2 ${ proof.name }$_cfu_formal.smt2
//
// Generated files belong to their user, without conditions.

`default_nettype none

<% include "core_stub.sv" %>

module ${ proof.name }$_cfu_formal (
    input wire clk,
    input wire reset,
    input wire cmd_valid,
    input wire [9:0] cmd_payload_function_id,
    input wire [31:0] cmd_payload_inputs_0,
    input wire [31:0] cmd_payload_inputs_1,
    input wire rsp_ready
);
    wire cmd_ready;
    wire rsp_valid;
    wire [31:0] rsp_payload_outputs_0;

    ${ proof.name }$_cfu dut (
        .clk(clk),
        .reset(reset),
        .cmd_valid(cmd_valid),
        .cmd_ready(cmd_ready),
        .cmd_payload_function_id(cmd_payload_function_id),
        .cmd_payload_inputs_0(cmd_payload_inputs_0),
        .cmd_payload_inputs_1(cmd_payload_inputs_1),
        .rsp_valid(rsp_valid),
        .rsp_ready(rsp_ready),
        .rsp_payload_outputs_0(rsp_payload_outputs_0)
    );

    // Internal signals of the design that the assertions read.
<%- for wire in proof.inside %>
    ${ wire }$
<%- endfor %>
    (* hierconn *) wire [9:0] \dut.taken ;

    // The reset is active in the first clock. The state before it is arbitrary.
    always @* if ($initstate) assume (reset);

    // The function id of the command that was taken last.
    wire taken = cmd_valid && cmd_ready;
    reg [9:0] asked;
    always @(posedge clk) if (taken) asked <= cmd_payload_function_id;
<% include "processor_answer.sv" %>

    wire [9:0] offered = cmd_payload_function_id;
    wire [31:0] word_0 = cmd_payload_inputs_0;
    wire [31:0] word_1 = cmd_payload_inputs_1;
    always @* if (!$initstate) begin
        assert (dut.core.rst_n == !reset);
        assert (dut.computing == dut.core.run);
        // A command waits only for a computation, or for an answer that nobody has taken.
        assert (cmd_ready == (!dut.core.run && !rsp_valid));
        assert (!(dut.core.run && rsp_valid));
        // A command that is taken starts a computation of its operands. Nothing else starts one.
        assert (dut.start == taken);
        if (taken) begin
<%- for (operand, bits) in proof.operands %>
            assert (dut.core.${ operand }$ == ${ bits }$);
<%- endfor %>
        end
        if (dut.core.run) assert (\dut.taken == asked);
    end
    always @(posedge clk) if (!$initstate && $past(!$initstate) && $past(!reset)) begin
        // Each computation gives one answer, which stays until it is taken.
        assert (rsp_valid == $past(dut.core.run && dut.core.ends || rsp_valid && !rsp_ready));
        if ($past(rsp_valid && !rsp_ready)) assert ($stable(rsp_payload_outputs_0));
        if ($past(dut.core.run && dut.core.ends)) begin
            assert (rsp_payload_outputs_0 == $past(known ? answer : 32'd0));
        end
    end
endmodule

`default_nettype wire
