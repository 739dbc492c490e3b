
    reg [31:0] awaddr = 32'd0;
    reg awvalid = 1'b0;
    wire awready;
    reg [31:0] wdata = 32'd0;
    reg [3:0] wstrb = 4'd0;
    reg wvalid = 1'b0;
    wire wready;
    wire [1:0] bresp;
    wire bvalid;
    reg bready = 1'b0;
    reg [31:0] araddr = 32'd0;
    reg arvalid = 1'b0;
    wire arready;
    wire [31:0] rdata;
    wire [1:0] rresp;
    wire rvalid;
    reg rready = 1'b0;
    reg address_taken;
    reg data_taken;
    ${ top }$ dut (
        .aclk(clk),
        .aresetn(~reset),
        .s_axil_awaddr(awaddr[${ address_high }$:0]),
        .s_axil_awprot(random[14:12]),
        .s_axil_awvalid(awvalid),
        .s_axil_awready(awready),
        .s_axil_wdata(wdata),
        .s_axil_wstrb(wstrb),
        .s_axil_wvalid(wvalid),
        .s_axil_wready(wready),
        .s_axil_bresp(bresp),
        .s_axil_bvalid(bvalid),
        .s_axil_bready(bready),
        .s_axil_araddr(araddr[${ address_high }$:0]),
        .s_axil_arprot(random[17:15]),
        .s_axil_arvalid(arvalid),
        .s_axil_arready(arready),
        .s_axil_rdata(rdata),
        .s_axil_rresp(rresp),
        .s_axil_rvalid(rvalid),
        .s_axil_rready(rready),
        .irq(irq)
    );

    // Does the write or the read that `access` asks for. Address, data and the ready for the
    // response come in random order.
    task do_access;
        begin
            address_taken = 1'b0;
            data_taken = ~asked_write;
            while (!answered) begin
                awvalid = asked_write && !address_taken && waited >= {30'd0, random[1:0]};
                wvalid = !data_taken && waited >= {30'd0, random[3:2]};
                arvalid = !asked_write && !address_taken && waited >= {30'd0, random[1:0]};
                bready = asked_write && waited >= {29'd0, random[6:4]};
                rready = !asked_write && waited >= {29'd0, random[6:4]};
                awaddr = awvalid ? asked_address | {30'd0, random[9:8]} : ~asked_address;
                araddr = arvalid ? asked_address | {30'd0, random[9:8]} : ~asked_address;
                wdata = wvalid ? asked_data : ~asked_data;
                wstrb = wvalid ? asked_bytes : ~asked_bytes;
                wait_a_clock;
                check((bvalid & rvalid) === 1'b0, "two answers");
                if (bvalid || rvalid) check(address_taken && data_taken, "an answer too early");
                if (awvalid && awready || arvalid && arready) address_taken = 1'b1;
                if (wvalid && wready) data_taken = 1'b1;
                answered = bvalid && bready || rvalid && rready;
                failed = asked_write ? bresp[1] : rresp[1];
                got = rdata;
                if (answered) check((asked_write ? bresp[0] : rresp[0]) === 1'b0, "the response");
                @(negedge clk);
            end
            {awvalid, wvalid, arvalid, bready, rready} = 5'd0;
        end
    endtask
