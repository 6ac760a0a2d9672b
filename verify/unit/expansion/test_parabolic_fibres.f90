!> Unit test of amontons_parabolic_fibres: the solids of the layers of a composite shell have exactly the displacement of one
!! solid of 20 or 15 nodes through all layers, whatever that is; the middle stays free; straight fibres stay straight.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_parabolic_fibres
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS, DIALECT_CALCULIX
  use amontons_shape_functions, only: shape_functions
  use amontons_structural_data, only: middle_node, parabola_weights, mean_weights, force_weights
  use amontons_element_kinds, only: KIND_C3D15, KIND_C3D20R, KIND_C3D15_LAYER, MAX_ELEMENT_NODES
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: MODEL_PART = '*NODE;1,0,0,0;2,2,.1,.1;3,2.2,1,0;4,0,1.1,.2;5,1,0,.1;6,2.1,.5,0;7,1,1,0;8,.1,.5,0;' // &
    '9,1.1,.5,.1;*MATERIAL, NAME=M;*ELASTIC;100.,0.3;'
  character(*), parameter :: STACKS(3) = [character(40) :: '.1,,M;.2,,M;.7,,M;', '.5,,M;.5,,M;', '.3,,M;.1,,M;.1,,M;.2,,M;.1,,M;']
  type(suite_type) :: suite
  integer :: i
  do i = 1, size(STACKS)
    call check_solids('*ELEMENT, TYPE=S8R, ELSET=E;1,1,2,3,4,5,6,7,8;', trim(STACKS(i)), KIND_C3D20R, KIND_C3D20R)
    call check_solids('*ELEMENT, TYPE=S6, ELSET=E;1,1,2,4,5,9,8;', trim(STACKS(i)), KIND_C3D15, KIND_C3D15_LAYER)
  end do
  call check_shared()
  call check_abaqus()
  call suite%finish()

contains

  !> The displacement of each layer at points inside it, of any displacement of bottom, top and middle.
  subroutine check_solids(element, stack, kind, layer_kind)
    character(*), intent(in) :: element, stack
    integer, intent(in) :: kind                  !< of one solid through all layers
    integer, intent(in) :: layer_kind            !< of the solids of the layers
    type(model_type) :: model
    real(DP), allocatable :: u(:, :)
    real(DP) :: solid(3, MAX_ELEMENT_NODES), place(3, MAX_ELEMENT_NODES), largest, off
    integer :: e, n_free
    call expect_read(element // '*SHELL SECTION, ELSET=E, COMPOSITE;' // stack, model, DIALECT_CALCULIX)
    call suite%that('kind of the layers', all(model%mesh%kind == layer_kind))
    allocate (u(3, model%mesh%n_nodes))
    call move_nodes(model, u, n_free)
    call suite%that('unknowns of one solid', n_free == merge(20, 15, kind == KIND_C3D20R))
    call gather_solid(model, u, solid)
    call gather_solid(model, model%mesh%coordinates, place)
    largest = 0
    off = 0
    do e = 1, model%mesh%n_elements
      call compare_layer(model, e, kind, u, solid, largest)
      call compare_layer(model, e, kind, model%mesh%coordinates, place, off)
    end do
    call suite%near('displacement inside the layers', largest, 0.0_DP, 2.0e-14_DP)
    call suite%near('position inside the layers', off, 0.0_DP, 2.0e-14_DP)
    call check_weights(model, u)
  end subroutine check_solids


  !> Displacements without any order; the inner nodes follow their equations.
  subroutine move_nodes(model, u, n_free)
    type(model_type), intent(in) :: model
    real(DP), intent(out) :: u(:, :)
    integer, intent(out) :: n_free               !< expanded nodes without an equation
    logical :: is_free(model%mesh%n_nodes)
    integer :: i, k
    do i = 1, model%mesh%n_nodes
      u(:, i) = [(sin(real(7 * i**2 + 3 * k, DP)), k=1, 3)]
    end do
    is_free = .true.
    is_free(:model%structure%n_deck_nodes) = .false.
    do i = 1, size(model%equations)
      associate (equation => model%equations(i))
        is_free(equation%node(1)) = .false.
        u(equation%dof(1), equation%node(1)) = -sum([(equation%coefficient(k) * u(equation%dof(k), equation%node(k)), k=2, &
          size(equation%node))]) / equation%coefficient(1)
      end associate
    end do
    n_free = count(is_free)
  end subroutine move_nodes


  !> Values at the nodes of one solid through all layers.
  subroutine gather_solid(model, values, solid)
    type(model_type), intent(in) :: model
    real(DP), intent(in) :: values(:, :)
    real(DP), intent(out) :: solid(3, MAX_ELEMENT_NODES)
    integer :: a, n
    solid = 0
    n = (model%structure%first(2) - 1) / 2       ! corners
    do a = 1, 2 * n
      associate (director => model%structure%directors(model%structure%director_of(a)))
        solid(:, merge(a, a + n, a <= n)) = values(:, director%nodes(1))
        solid(:, merge(a + n, a + 2 * n, a <= n)) = values(:, director%nodes(2))
        if (a <= n) solid(:, a + 4 * n) = matmul(values(:, director%nodes([1, 2, middle_node(director)])), &
          parabola_weights(director, 0.5_DP))
      end associate
    end do
  end subroutine gather_solid


  !> The largest difference of a layer from one solid, at places inside the layer.
  subroutine compare_layer(model, e, kind, values, solid, largest)
    type(model_type), intent(in) :: model
    integer, intent(in) :: e, kind
    real(DP), intent(in) :: values(:, :), solid(3, MAX_ELEMENT_NODES)
    real(DP), intent(inout) :: largest
    real(DP) :: N(MAX_ELEMENT_NODES), dN(3, MAX_ELEMENT_NODES), xi(3), of_layer(3), heights(2)
    integer :: i
    heights = 2 * model%structure%directors(1)%height(e - 1:e)
    associate (nodes => model%mesh%nodes(model%mesh%first(e):model%mesh%first(e + 1) - 1))
      do i = 1, 5
        xi = [0.1_DP * real(i, DP), 0.55_DP - 0.1_DP * real(i, DP), 0.37_DP * real(i, DP) - 1.1_DP]
        call shape_functions(model%mesh%kind(e), xi, N, dN)
        of_layer = matmul(values(:, nodes), N(:size(nodes)))
        xi(3) = 0.5_DP * ((1 - xi(3)) * heights(1) + (1 + xi(3)) * heights(2))
        call shape_functions(kind, xi, N, dN)
        largest = max(largest, maxval(abs(of_layer - matmul(solid, N))))
      end do
    end associate
  end subroutine compare_layer


  !> The weights of a node at a corner are those of a fibre with one middle.
  subroutine check_weights(model, u)
    type(model_type), intent(in) :: model
    real(DP), intent(in) :: u(:, :)
    real(DP) :: of_solid(3, 3)
    associate (director => model%structure%directors(model%structure%director_of(1)))
      of_solid(:, :2) = u(:, director%nodes(:2))
      of_solid(:, 3) = matmul(u(:, director%nodes([1, 2, middle_node(director)])), parabola_weights(director, 0.5_DP))
      call suite%near('displacement of the node', maxval(abs(matmul(u(:, director%nodes), &
        mean_weights(director, .true., .false.)) - &
        matmul(of_solid, [real(DP) :: 1, 1, 4] / 6))), 0.0_DP, 1.0e-14_DP)
      call suite%near('force on the node', maxval(abs(matmul(u(:, director%nodes), force_weights(director, .true., .false.)) - &
        matmul(of_solid, [-0.5_DP, -0.5_DP, 2.0_DP]))), 0.0_DP, 1.0e-13_DP)
    end associate
  end subroutine check_weights


  !> Elements of different layers share the fibres of their common side; all solids have the displacement of the fibres.
  subroutine check_shared()
    type(model_type) :: model
    real(DP), allocatable :: u(:, :)
    real(DP) :: of_layers(3), of_one(3), largest, share
    integer :: n_free, i, e
    call expect_read('*NODE;11,3,0,.1;12,3,1,0;13,2.5,0,.1;14,3,.5,0;15,2.5,1,0;*ELEMENT, TYPE=S8R, ELSET=E;1,1,2,3,4,5,6,7,8;' // &
      '*ELEMENT, TYPE=S8R, ELSET=F;2,2,11,12,3,13,14,15,6;*SHELL SECTION, ELSET=E, COMPOSITE;.1,,M;.2,,M;.7,,M;' // &
      '*SHELL SECTION, ELSET=F, MATERIAL=M;1.;', model, DIALECT_CALCULIX)
    allocate (u(3, model%mesh%n_nodes))
    call move_nodes(model, u, n_free)
    call suite%that('one fibre for both', size(model%nonlinear_mpcs) == 0 .and. size(model%structure%directors) == 13)
    call suite%that('unknowns of two solids', n_free == 20 + 20 - 8)
    largest = 0
    do e = 1, 3
      do i = 1, 5
        call find_point(model, e, [1.0_DP, 0.4_DP * real(i, DP) - 1.2_DP, 0.3_DP * real(i, DP) - 1.0_DP], u, of_layers)
        associate (heights => 2 * model%structure%directors(model%structure%director_of(1))%height(e - 1:e))
          share = 0.15_DP * real(i, DP)
          call find_point(model, 4, [-1.0_DP, 0.4_DP * real(i, DP) - 1.2_DP, (1 - share) * heights(1) + share * heights(2)], u, &
            of_one)
        end associate
        largest = max(largest, maxval(abs(of_layers - of_one)))
      end do
    end do
    call suite%near('no gap between them', largest, 0.0_DP, 2.0e-14_DP)
  end subroutine check_shared


  !> A value inside a solid.
  subroutine find_point(model, e, xi, values, found)
    type(model_type), intent(in) :: model
    integer, intent(in) :: e
    real(DP), intent(in) :: xi(3), values(:, :)
    real(DP), intent(out) :: found(3)
    real(DP) :: N(MAX_ELEMENT_NODES), dN(3, MAX_ELEMENT_NODES)
    call shape_functions(model%mesh%kind(e), xi, N, dN)
    associate (nodes => model%mesh%nodes(model%mesh%first(e):model%mesh%first(e + 1) - 1))
      found = matmul(values(:, nodes), N(:size(nodes)))
    end associate
  end subroutine find_point


  !> In the abaqus dialect each layer has unknowns of its own.
  subroutine check_abaqus()
    type(model_type) :: model
    real(DP), allocatable :: u(:, :)
    integer :: n_free
    call expect_read('*ELEMENT, TYPE=S8R, ELSET=E;1,1,2,3,4,5,6,7,8;*SHELL SECTION, ELSET=E, COMPOSITE;.1,,M;.2,,M;', model, &
      DIALECT_ABAQUS)
    allocate (u(3, model%mesh%n_nodes))
    call move_nodes(model, u, n_free)
    call suite%that('abaqus: free', n_free == 20 + 12)
  end subroutine check_abaqus


  !> A model without errors.
  subroutine expect_read(text, model, dialect)
    character(*), intent(in) :: text
    type(model_type), intent(out) :: model
    integer, intent(in) :: dialect
    type(diagnostic_list_type) :: diagnostics
    type(error_type), allocatable :: error
    call read_deck_text(deck_lines(MODEL_PART // text // '*STEP;*STATIC;*END STEP;'), job_options_type(dialect=dialect), model, &
      diagnostics, error)
    call suite%that(text, .not. allocated(error))
  end subroutine expect_read

end program test_parabolic_fibres
