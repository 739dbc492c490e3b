// ${ name }$_axil_formal: formal properties of ${ name }$_axil
//
// For formal tools only. The master obeys the rules of AXI and is arbitrary otherwise. A stub that
// answers requests at arbitrary times replaces the registers. To prove the properties, run in a
// directory with the files of both folders:
//   $ yosys -q ${ name }$_axil_formal.ys
//   $ yosys-smtbmc -s z3 --unroll -t 3 ${ name }$_axil_formal.smt2
//   $ yosys-smtbmc -s z3 --unroll -i -t 2 ${ name }$_axil_formal.smt2
//
// Generated files belong to their user, without conditions.

`default_nettype none

<% include "registers_stub.sv" %>

module ${ name }$_axil_formal (
    input wire aclk,
    input wire aresetn,
    input wire [${ address_high }$:0] s_axil_awaddr,
    input wire [2:0] s_axil_awprot,
    input wire s_axil_awvalid,
    input wire [31:0] s_axil_wdata,
    input wire [3:0] s_axil_wstrb,
    input wire s_axil_wvalid,
    input wire s_axil_bready,
    input wire [${ address_high }$:0] s_axil_araddr,
    input wire [2:0] s_axil_arprot,
    input wire s_axil_arvalid,
    input wire s_axil_rready
);
    wire s_axil_awready;
    wire s_axil_wready;
    wire [1:0] s_axil_bresp;
    wire s_axil_bvalid;
    wire s_axil_arready;
    wire [31:0] s_axil_rdata;
    wire [1:0] s_axil_rresp;
    wire s_axil_rvalid;
    wire irq;

    ${ name }$_axil dut (
        .aclk(aclk),
        .aresetn(aresetn),
        .s_axil_awaddr(s_axil_awaddr),
        .s_axil_awprot(s_axil_awprot),
        .s_axil_awvalid(s_axil_awvalid),
        .s_axil_awready(s_axil_awready),
        .s_axil_wdata(s_axil_wdata),
        .s_axil_wstrb(s_axil_wstrb),
        .s_axil_wvalid(s_axil_wvalid),
        .s_axil_wready(s_axil_wready),
        .s_axil_bresp(s_axil_bresp),
        .s_axil_bvalid(s_axil_bvalid),
        .s_axil_bready(s_axil_bready),
        .s_axil_araddr(s_axil_araddr),
        .s_axil_arprot(s_axil_arprot),
        .s_axil_arvalid(s_axil_arvalid),
        .s_axil_arready(s_axil_arready),
        .s_axil_rdata(s_axil_rdata),
        .s_axil_rresp(s_axil_rresp),
        .s_axil_rvalid(s_axil_rvalid),
        .s_axil_rready(s_axil_rready),
        .irq(irq)
    );

    // Internal signals of the design that the assertions read.
    (* hierconn *) wire \dut.write_taken ;
    (* hierconn *) wire \dut.write ;
    (* hierconn *) wire \dut.read ;
    (* hierconn *) wire \dut.write_answer ;
    (* hierconn *) wire \dut.write_error ;
    (* hierconn *) wire \dut.read_answer ;
    (* hierconn *) wire \dut.read_error ;
    (* hierconn *) wire [31:0] \dut.read_data ;
<% include "registers_inside.sv" %>

    // The reset is active in the first clock. The state before it is arbitrary.
    always @* if ($initstate) assume (!aresetn);

    // Assumption: a valid of the master and its payload stay unchanged until the ready.
    always @(posedge aclk) if (!$initstate && $past(aresetn)) begin
        if ($past(s_axil_awvalid && !s_axil_awready)) begin
            assume (s_axil_awvalid && $stable(s_axil_awaddr));
        end
        if ($past(s_axil_wvalid && !s_axil_wready)) begin
            assume (s_axil_wvalid && $stable({s_axil_wdata, s_axil_wstrb}));
        end
        if ($past(s_axil_arvalid && !s_axil_arready)) begin
            assume (s_axil_arvalid && $stable(s_axil_araddr));
        end
    end

    // The numbers of accepted requests and of accepted responses, modulo 4. Fewer than 4 can be
    // outstanding, so equal numbers modulo 4 are equal.
    reg [1:0] addresses;
    reg [1:0] words;
    reg [1:0] answers;
    reg [1:0] reads;
    reg [1:0] results;
    // The error bits of the last answers of the registers.
    reg write_failed;
    reg read_failed;
    always @(posedge aclk) begin
        if (!aresetn) begin
            addresses <= 0;
            words <= 0;
            answers <= 0;
            reads <= 0;
            results <= 0;
        end else begin
            addresses <= addresses + (s_axil_awvalid && s_axil_awready);
            words <= words + (s_axil_wvalid && s_axil_wready);
            answers <= answers + (s_axil_bvalid && s_axil_bready);
            reads <= reads + (s_axil_arvalid && s_axil_arready);
            results <= results + (s_axil_rvalid && s_axil_rready);
        end
        if (dut.write_answer) write_failed <= dut.write_error;
        if (dut.read_answer) read_failed <= dut.read_error;
    end

    always @* if (!$initstate) begin
        // Every request gets one response: an accepted request without an accepted response has a
        // valid response.
        assert (addresses == answers + s_axil_bvalid);
        assert (words == addresses);
        assert (reads == results + s_axil_rvalid);
        // Address and data of a write are accepted together, and no response is valid in that
        // clock.
        assert (s_axil_awready == s_axil_wready);
        if (s_axil_awready) assert (!s_axil_bvalid);
        if (s_axil_arready) assert (!s_axil_rvalid);
        // A request reaches the registers once, and as soon as its response has room.
        assert (dut.write == (s_axil_awvalid && s_axil_wvalid && !s_axil_awready
                && (s_axil_bready || !s_axil_bvalid)));
        assert (dut.read == (s_axil_arvalid && !s_axil_arready
                && (s_axil_rready || !s_axil_rvalid)));
        // The registers get the address, data and byte enables of the request.
        assert (\dut.registers.rst_n == aresetn && irq == \dut.registers.irq );
        if (dut.write) begin
            assert (\dut.registers.write_at == s_axil_awaddr[${ address_high }$:2]);
            assert (\dut.registers.write_data == s_axil_wdata);
            assert (\dut.registers.write_bytes == s_axil_wstrb);
        end
        if (dut.read) assert (\dut.registers.read_at == s_axil_araddr[${ address_high }$:2]);
        // The response has the error bit of the registers.
        if (dut.write_taken || s_axil_bvalid) assert (s_axil_bresp == {write_failed, 1'b0});
        if (s_axil_arready || s_axil_rvalid) assert (s_axil_rresp == {read_failed, 1'b0});
    end

    always @(posedge aclk) if (!$initstate && $past(!$initstate)) begin
        // The master sees ready in the clock after the registers executed the request.
        assert (s_axil_awready == $past(aresetn && dut.write_answer));
        assert (s_axil_arready == $past(aresetn && dut.read_answer));
        if (s_axil_awready && aresetn) assert (s_axil_awvalid && s_axil_wvalid);
        if (s_axil_arready && aresetn) assert (s_axil_arvalid);
        if ($past(aresetn)) begin
            // A valid response stays unchanged until the master accepts it.
            if ($past(s_axil_bvalid && !s_axil_bready)) begin
                assert (s_axil_bvalid && s_axil_bresp == $past(s_axil_bresp));
            end
            if ($past(s_axil_rvalid && !s_axil_rready)) begin
                assert (s_axil_rvalid && s_axil_rresp == $past(s_axil_rresp));
                assert (s_axil_rdata == $past(s_axil_rdata));
            end
            // The response is valid in the clock after the request was accepted.
            if ($past(s_axil_awready)) assert (s_axil_bvalid);
            if ($past(s_axil_arready)) begin
                assert (s_axil_rvalid && s_axil_rdata == $past(dut.read_data));
            end
        end else begin
            assert (!s_axil_bvalid && !s_axil_rvalid);
            assert (!s_axil_awready && !s_axil_wready && !s_axil_arready);
        end
    end
endmodule

`default_nettype wire
