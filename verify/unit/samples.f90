!> Samples that several unit tests share: decks, dense matrices, chains of elements with a contact row, smooth normals.
!! SPDX-License-Identifier: GPL-3.0-or-later
module samples
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_text, only: to_text, NEWLINE
  use amontons_mesh, only: mesh_type
  use amontons_facets, only: facets_type, facet_nodes
  use amontons_shape_functions, only: facet_shapes
  use amontons_surface_projection, only: evaluate_vertex_normal
  use amontons_element_kinds, only: MAX_FACE_NODES, KIND_T3D2
  use amontons_sparse, only: sparse_type, sparse_from_triplets
  use amontons_constraints, only: constraints_type, constraint_row_type, add_constraint_row, eliminate_constraints
  implicit none
  private
  public :: deck_lines, horseshoe, two_squares, last_step, dense_of, add_oblique_row, make_chain_mesh, evaluate_smooth_normal

contains

  !> The lines of a deck that is written with a semicolon at the end of each.
  pure function deck_lines(text) result(lines)
    character(*), intent(in) :: text
    character(len(text)) :: lines
    integer :: i
    lines = text
    do i = 1, len(text)
      if (text(i:i) == ';') lines(i:i) = NEWLINE
    end do
  end function deck_lines


  !> Three CPE4: a back and two arms of length 1, a slot of a width between them.
  function horseshoe(width) result(cards)
    real(DP), intent(in) :: width
    character(:), allocatable :: cards
    cards = '*NODE;1,0.,0.;2,1.,0.;3,2.,0.;4,0.,1.;5,1.,1.;6,2.,1.;7,0.,' // to_text(1 + width) // ';8,1.,' // &
      to_text(1 + width) // ';9,2.,' // to_text(1 + width) // ';10,0.,' // to_text(2 + width) // ';11,1.,' // to_text(2 + width) &
      // ';12,2.,' // to_text(2 + width) // ';*ELEMENT, TYPE=CPE4, ELSET=SHOE;1,2,3,6,5;2,1,2,5,4;3,8,9,12,11;4,7,8,11,10;' // &
      '5,4,5,8,7;*MATERIAL, NAME=M;*ELASTIC;100.,0.3;*SOLID SECTION, ELSET=SHOE, MATERIAL=M;*SURFACE, NAME=SHOE_S;SHOE,;'
  end function horseshoe


  !> A square UP (CPE4) above another one LOW, which is twice as wide, with its top at y = 1, the surfaces S_UP and S_LOW, and a
  !! step under NLGEOM that moves the upper one down by a half.
  function two_squares(height, cards) result(deck)
    real(DP), intent(in) :: height                 !< y of the bottom of the upper square [length]
    character(*), intent(in) :: cards              !< before the step
    character(:), allocatable :: deck
    deck = deck_lines('*NODE;1,-0.5,0.;2,1.5,0.;3,1.5,1.;4,-0.5,1.;5,0.,' // to_text(height) // ';6,1.,' // to_text(height) // &
      ';7,1.,' // to_text(height + 1) // ';8,0.,' // to_text(height + 1) // ';*ELEMENT, TYPE=CPE4, ELSET=LOW;1,1,2,3,4;' // &
      '*ELEMENT, TYPE=CPE4, ELSET=UP;2,5,6,7,8;*MATERIAL, NAME=M;*ELASTIC;100.,0.3;*SOLID SECTION, ELSET=LOW, MATERIAL=M;' // &
      '*SOLID SECTION, ELSET=UP, MATERIAL=M;*SURFACE, NAME=S_UP;UP, S1;UP, S2;UP, S4;*SURFACE, NAME=S_LOW;LOW, S3;' // cards // &
      '*STEP, NLGEOM;*STATIC;*BOUNDARY;1,1,2;2,2;5,1;5,2,2,-0.5;6,2,2,-0.5;*END STEP;')
  end function two_squares


  !> A step that moves a corner by 0.4.
  pure function last_step(options) result(cards)
    character(*), intent(in) :: options
    character(:), allocatable :: cards
    cards = '*STEP' // options // ';*STATIC;*BOUNDARY;1,1,2;12,2,2,-0.4;*END STEP;'
  end function last_step


  !> A sparse matrix with all its zeros; of a symmetric one the upper triangle is given.
  pure function dense_of(matrix, is_symmetric) result(full)
    type(sparse_type), intent(in) :: matrix
    logical, intent(in), optional :: is_symmetric  !< .false. if absent
    real(DP) :: full(matrix%n_rows, matrix%n_columns)
    logical :: is_mirrored
    integer :: i, p
    is_mirrored = .false.
    if (present(is_symmetric)) is_mirrored = is_symmetric
    full = 0.0_DP
    do i = 1, matrix%n_rows
      do p = matrix%first(i), matrix%first(i + 1) - 1
        full(i, matrix%column(p)) = matrix%value(p)
        if (is_mirrored) full(matrix%column(p), i) = matrix%value(p)
      end do
    end do
  end function dense_of


  !> An oblique contact row between two nodes, with friction along y that follows the reaction (D_R) and a force that follows the
  !! displacement along z (D_u).
  subroutine add_oblique_row(slave, master, mu, constraints, D_R, D_u)
    integer, intent(in) :: slave, master           !< nodes
    real(DP), intent(in) :: mu                     !< friction coefficient
    type(constraints_type), intent(inout) :: constraints   !< in: supports, not yet eliminated; out: eliminated
    type(sparse_type), intent(out) :: D_R, D_u
    type(constraint_row_type) :: row
    type(error_type), allocatable :: error
    integer :: at, to, n, status
    at = 3 * (slave - 1)
    to = 3 * (master - 1)
    n = constraints%n_unknowns
    row%unknown = [at + 1, at + 2, to + 1, to + 2]
    row%coefficient = [1.0_DP, 0.5_DP, -1.0_DP, -0.5_DP]
    call add_constraint_row(constraints, row, 1, 1.0e-9_DP, status)
    call eliminate_constraints(constraints)
    call sparse_from_triplets(n, n, [at + 1, at + 2, to + 1, to + 2], [at + 1, at + 1, at + 1, at + 1], &
      [-0.2_DP, mu, 0.2_DP, -mu], D_R, error)
    call sparse_from_triplets(n, n, [at + 3, to + 3], [at + 3, at + 2], [-0.7_DP, 0.4_DP], D_u, error)
  end subroutine add_oblique_row


  !> Nodes that bars join one after the other.
  subroutine make_chain_mesh(coordinates, mesh)
    real(DP), intent(in) :: coordinates(:)         !< x, y, z of each node
    type(mesh_type), intent(out) :: mesh
    integer :: i, n
    n = size(coordinates) / 3
    mesh%n_nodes = n
    mesh%n_elements = n - 1
    allocate (mesh%kind(mesh%n_elements), source=KIND_T3D2)
    mesh%coordinates = reshape(coordinates, [3, n])
    mesh%first = [(2 * i - 1, i=1, n)]
    mesh%nodes = [((i + 1) / 2 + mod(i + 1, 2), i=1, 2 * (n - 1))]
  end subroutine make_chain_mesh


  !> Smooth normal n(xi) of a facet: interpolated unit vertex normals (doc/theory/contact.md).
  pure subroutine evaluate_smooth_normal(facets, x, f, xi, n)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) current coordinates [length]
    integer, intent(in) :: f                       !< facet
    real(DP), intent(in) :: xi(2)                  !< natural coordinates [-]
    real(DP), intent(out) :: n(3)                  !< [-]
    real(DP) :: shape(MAX_FACE_NODES), slope(2, MAX_FACE_NODES), curvature(3, MAX_FACE_NODES), m(3)
    integer :: nodes(MAX_FACE_NODES), n_nodes, i
    call facet_nodes(facets, f, n_nodes, nodes)
    call facet_shapes(facets%kind(f), xi, shape, slope, curvature)
    n = 0.0_DP
    do i = 1, n_nodes
      m = evaluate_vertex_normal(facets, x, facets%vertex(facets%first(f) + i - 1))
      n = n + shape(i) * m / norm2(m)
    end do
    n = n / norm2(n)
  end subroutine evaluate_smooth_normal

end module samples
